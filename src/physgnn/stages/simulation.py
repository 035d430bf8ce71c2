"""From a mesh to a dataset of load paths."""

import sys
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from physgnn.dataset import (
    SOLVERS,
    Generation,
    Preset,
    Store,
    generate,
    verify,
)
from physgnn.dataset.generate import DEFAULT_SOLVER, check_febio
from physgnn.dataset.presets import find_preset
from physgnn.errors import InputError
from physgnn.geometry import TetMesh
from physgnn.io.febio_run import find_febio
from physgnn.progress import Progress


def simulate(
    mesh: TetMesh,
    preset: str | Preset,
    store: str | Path,
    *,
    solver: str = DEFAULT_SOLVER,
    workers: int = 1,
    scheduler: str | None = None,
    source: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> tuple[Store, Generation]:
    """Solve the load paths of a preset on a mesh; a second call resumes.

    A sample of the levels is checked, see `physgnn.dataset.verification`.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    preset : str or Preset
        A row of ``PRESETS``, or a preset of the user's own.
    store : path
        Where the dataset is or is to be.
    solver : str
        A row of ``SOLVERS``.
    workers, scheduler, progress
        See `physgnn.dataset.generate`.
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
    mesh, paths = preset.on(mesh)
    if solver == "febio":
        check_febio(preset.element, paths)
    opened = Store.resume(
        store,
        mesh,
        paths,
        materials=preset.materials,
        fixed=mesh.point_set("fixed"),
        element=preset.element,
        provenance={
            "preset": name,
            "solver": solver,
            "physgnn": version("physgnn"),
            **(source or {}),
        },
    )
    before = opened.provenance.get("solver", DEFAULT_SOLVER)
    if before != solver:
        raise InputError(
            f"store {store} was begun with --solver {before}: go on with that, or name "
            "another store"
        )
    where: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    did = generate(opened, progress=progress, **where)
    verify(opened, progress=progress, **where)
    return opened, did


def command_line() -> str:
    """Return what the user typed, for the record."""
    return " ".join(["physgnn", *sys.argv[1:]])
