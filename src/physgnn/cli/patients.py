"""Commands for patients no network has seen: a family to learn from."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn.cli.console import progress


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
