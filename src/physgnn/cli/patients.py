"""Commands for patients no network has seen: a family to learn from, and use."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import stages
from physgnn.cli.console import progress, say, working
from physgnn.cli.options import LoadsOption, OutFolder, PresetOption


def anatomies(
    out: OutFolder,
    count: Annotated[int, typer.Option(help="Draw this many patients.")] = 12,
    seed: Annotated[
        int,
        typer.Option(
            help="Draw the first patient from this seed, and the others from the ones "
            "after it."
        ),
    ] = 0,
) -> None:
    """Draw synthetic patients: brains, tumours and craniotomies, as meshes."""
    with progress("meshing") as move:
        made = stages.anatomies(out, count=count, seed=seed, progress=move)
    print(f"{out}: {len(made)} patients, {made[0].name} to {made[-1].name}")


def init(
    case: Annotated[Path, typer.Argument(help="The patient's mesh, VTU.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to write, TOML.")],
    craniotomy: Annotated[
        Path | None,
        typer.Option(
            help="One point in the middle of the craniotomy: .mrk.json, .fcsv or CSV; "
            "by default the cortex nearest to the tumour."
        ),
    ] = None,
    radius_mm: Annotated[
        float, typer.Option(help="Lay the cortex open over this radius.")
    ] = 30.0,
) -> None:
    """Write what to simulate on a patient, for simulate and adapt --loads."""
    stages.init(case, out, craniotomy=craniotomy, radius_mm=radius_mm, log=say)
    print(f"{out}: run physgnn simulate {case} --loads {out} -o loads.zarr")


def adapt(
    run: Annotated[
        Path,
        typer.Argument(
            help="The folder of a lifted network trained with pod_modes = 0."
        ),
    ],
    case: Annotated[Path, typer.Argument(help="The new patient's mesh, VTU.")],
    out: OutFolder,
    preset: PresetOption = None,
    loads: LoadsOption = None,
) -> None:
    """Make a trained network ready for a patient it never saw, in seconds."""
    with working("finding equilibria"):
        made = stages.adapt(run, case, out, preset=preset, loads=loads)
    bound = (
        "no error bounds"
        if made.coverage is None
        else f"error bounds that hold for {100 * made.coverage:.0f} % of new patients"
    )
    print(f"{out}: {made.n_points} points, {made.seconds:.1f} s, {bound}")
