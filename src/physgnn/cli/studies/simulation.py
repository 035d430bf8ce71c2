"""The commands that make datasets: synthetic patients, and solved load paths."""

from pathlib import Path
from typing import Annotated

import typer

from physgnn import choices, stages
from physgnn.cli.console import NOT_USABLE, progress, say
from physgnn.cli.options import LoadsOption, OutFolder, PresetOption

SHOWN_REMARKS, SHOWN_ERRORS = 20, 3


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
    plural = "" if len(made) == 1 else "s"
    print(f"{out}: {len(made)} patient{plural}, {made[0].name} to {made[-1].name}")


def simulate(
    case: Annotated[Path, typer.Argument(help="The mesh, VTU.")],
    out: Annotated[
        Path, typer.Option("--out", "-o", help="The dataset to make, or to complete.")
    ],
    preset: PresetOption = None,
    loads: LoadsOption = None,
    training_paths: Annotated[
        int,
        typer.Option(
            min=0,
            help="Add so many load paths of the same kind, of another draw, that every "
            "split trains on and none holds out.",
        ),
    ] = 0,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Solve in this many processes on this machine; by default in one for "
            "each processor.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Solve on the workers of the Dask scheduler at this address "
            "(tcp://…), instead of on this machine."
        ),
    ] = None,
    solver: Annotated[
        choices.SolverName,
        typer.Option(
            help="Solve by our finite elements, by FEBio, or without elements (mtled)."
        ),
    ] = "physgnn",
) -> None:
    """Solve load paths, by default by finite elements; call it again to resume."""
    with progress("simulating") as move:
        store, did = stages.simulate(
            case,
            out,
            preset=preset,
            loads=loads,
            training_paths=training_paths,
            workers=workers,
            scheduler=scheduler,
            solver=solver,
            progress=move,
            log=say,
        )
    from physgnn.dataset import verification_of

    print(
        f"{out}: {did.solved} load paths solved now, {len(store.pending())} pending; "
        f"{len(store.samples())} of {store.n_paths * store.n_levels} levels converged"
    )
    print(verification_of(store))
    for path, remark in [*store.messages().items()][:SHOWN_REMARKS]:
        print(f"load path {path} {remark}")
    for path, error in [*did.errors.items()][:SHOWN_ERRORS]:
        say(f"load path {path}: {error}")
    if did.errors:
        raise typer.Exit(1)
    if not len(store.samples()):
        say("no level converged: is the mesh in mm, are the loads in N?")
        raise typer.Exit(NOT_USABLE)
