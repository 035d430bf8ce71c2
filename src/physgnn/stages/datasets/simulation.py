"""From a mesh to a dataset of load paths."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from physgnn.dataset import SOLVERS, Generation, Preset, Store, generate, verify
from physgnn.dataset.generation.pending_paths import (
    DEFAULT_SOLVER,
    FINITE_ELEMENTS,
    check_febio,
)
from physgnn.dataset.presets import find_preset
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.io import read_mesh
from physgnn.io.febio.run import find_febio
from physgnn.mechanics.body import Body
from physgnn.progress import Log, Progress, no_log
from physgnn.stages.datasets.chosen_loads import chosen_preset
from physgnn.stages.datasets.provenance import command_line
from physgnn.stages.outputs import FOLDER, writes
from physgnn.versions import release


@writes(out=FOLDER)
def simulate(
    case: str | Path,
    out: str | Path,
    *,
    preset: str | None = None,
    loads: str | Path | None = None,
    training_paths: int = 0,
    workers: int | None = None,
    scheduler: str | None = None,
    solver: str = DEFAULT_SOLVER,
    progress: Progress | None = None,
    log: Log = no_log,
) -> tuple[Store, Generation]:
    """Solve load paths, by finite elements or without; a second call resumes.

    Parameters
    ----------
    case : path
        Mesh, VTU.
    out : path
        Where the dataset is or is to be.
    preset : str, optional
        A row of ``PRESETS``; or else `loads`.
    loads : path, optional
        TOML with point sets, materials and loads: see `physgnn.config.simulation`.
    training_paths : int
        So many further load paths of the same kind, of another draw: every split trains
        on them, and none holds them out.
    workers : int, optional
        Processes on this machine; by default as many as it has processors. A script
        that asks for more than one calls this under ``if __name__ == "__main__"``.
    scheduler : str, optional
        Address of a Dask scheduler, instead of workers.
    solver : str
        A row of ``SOLVERS``.
    progress : callable, optional
        Called with the paths done, the paths in all, and how the last one ended.
    log : callable
        Called with a line if the mesh seems to be in another unit than mm.

    Returns
    -------
    Store, Generation
        The dataset, and what was done now.

    Raises
    ------
    InputError
        If a file cannot be used, or preset, mesh, solver and dataset do not fit each
        other.
    """
    chosen = chosen_preset(preset, loads)
    return simulate_mesh(
        read_mesh(case, log=log),
        chosen,
        out,
        training_paths=training_paths,
        solver=solver,
        workers=processes(workers),
        scheduler=scheduler,
        source={"mesh": str(case), "command": command_line()},
        progress=progress,
    )


def processes(workers: int | None = None) -> int:
    """Return how many processes to start: as asked, or one for each processor."""
    return workers if workers is not None else os.cpu_count() or 1


def simulate_mesh(
    mesh: TetMesh,
    preset: str | Preset,
    store: str | Path,
    *,
    training_paths: int = 0,
    solver: str = DEFAULT_SOLVER,
    workers: int = 1,
    scheduler: str | None = None,
    source: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> tuple[Store, Generation]:
    """Solve the load paths of a preset on a mesh; a second call resumes.

    A sample of the levels that finite elements gave is checked, see
    `physgnn.dataset.generation.verification`.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    preset : str or Preset
        A row of ``PRESETS``, or a preset of the user's own.
    store : path
        Where the dataset is or is to be.
    training_paths : int
        So many further paths, for training alone.
    solver : str
        A row of ``SOLVERS``.
    workers, scheduler, progress
        See `physgnn.dataset.generation.pending_paths`.
    source : mapping, optional
        Where mesh and loads come from, for the record; what JSON can hold.

    Raises
    ------
    InputError
        If preset, mesh, solver and store do not fit each other.
    """
    if solver not in SOLVERS:
        raise InputError(f"no solver '{solver}' (there are: {', '.join(SOLVERS)})")
    if solver == "febio" and scheduler is None:
        find_febio()
    name = preset if isinstance(preset, str) else "custom"
    if isinstance(preset, str):
        preset = find_preset(preset)
    mesh, paths = preset.on(mesh, training_paths)
    if solver == "febio":
        check_febio(preset.element, paths)
    opened = Store.resume(
        store,
        Body(mesh, preset.materials, mesh.point_set("fixed"), element=preset.element),
        paths,
        provenance={
            "preset": name,
            "solver": solver,
            "physgnn": release("physgnn"),
            **(source or {}),
        },
        training_paths=training_paths,
    )
    before = opened.provenance.get("solver", DEFAULT_SOLVER)
    if before != solver:
        raise InputError(
            f"store {store} was begun with --solver {before}: go on with that, or name "
            "another store"
        )
    where: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    did = generate(opened, progress=progress, **where)
    if solver in FINITE_ELEMENTS:
        verify(opened, progress=progress, **where)
    return opened, did
