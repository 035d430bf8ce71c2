"""Commands for patients no network has seen: a family to learn from, and use."""

from pathlib import Path
from typing import Annotated, Any

import typer

from physgnn.cli.console import progress, working
from physgnn.errors import InputError


def anatomies(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the meshes.")],
    count: Annotated[int, typer.Option(help="How many.")] = 12,
    seed: Annotated[int, typer.Option(help="Of the first; others follow.")] = 0,
) -> None:
    """Draw synthetic patients: brains, tumours and craniotomies, as meshes."""
    from physgnn.stages.anatomies import make_anatomies

    with progress("meshing") as move:
        made = make_anatomies(out, count, seed=seed, progress=move)
    print(f"{out}: {len(made)} patients, {made[0].name} to {made[-1].name}")


def adapt(
    run: Annotated[Path, typer.Argument(help="Folder of a network without modes.")],
    case: Annotated[Path, typer.Argument(help="The new patient's mesh, VTU.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the new run.")],
    preset: Annotated[
        str | None, typer.Option(help="paper-1, paper-2, demo or family.")
    ] = None,
    loads: Annotated[
        Path | None, typer.Option(help="TOML with point sets, materials and loads.")
    ] = None,
) -> None:
    """Make a trained network ready for a patient it never saw, in seconds."""
    from physgnn.config import read_preset
    from physgnn.io import read_mesh
    from physgnn.stages.adaptation import adapt_run

    if (preset is None) == (loads is None):
        raise InputError("give --preset or --loads")
    chosen: Any = preset if loads is None else read_preset(loads)
    with working("finding equilibria"):
        made = adapt_run(run, read_mesh(case), chosen, out)
    bound = (
        "no error bounds"
        if made.coverage is None
        else (f"error bounds that hold for {100 * made.coverage:.0f} % of new patients")
    )
    print(f"{out}: {made.n_points} points, {made.seconds:.1f} s, {bound}")
