"""The data of the benchmark's tasks: taken from a folder, or made small."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.dataset import Preset, Store, named_split
from physgnn.dataset.splits.samples import MESH, Split
from physgnn.errors import InputError
from physgnn.geometry import TetMesh, mni152_phantom
from physgnn.io.untrusted.compressed import read_npz
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers
from physgnn.progress import Progress, no_progress
from physgnn.stages.datasets.simulation import processes, simulate_mesh
from physgnn.stages.experiments.benchmark.benchmark_shifts import shift_data
from physgnn.stages.patient.preoperative.surface_meshing import mesh_surfaces

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.benchmark.job import TaskData
    from physgnn.evaluation.benchmark.shift_data import ShiftData
    from physgnn.evaluation.benchmark.tasks import Task

HELD_OUT = 120  # samples of a full task to test on, and to validate on, at most
SURFACE_POINTS, LARGEST_CELL_MM3 = 300, 1e4  # of the tiny mesh: some 800 points
MESH_TASK = "mesh-never-seen"
TRAINED, UNSEEN = "trained", "unseen.zarr"  # in the folder of mesh-never-seen
# Tumours and sizes of the tiny bodies: radius, mm, and scale along x, y and z. The
# last is the one never seen.
BODIES = (
    (11.0, (1.0, 1.0, 1.0)),
    (9.0, (1.04, 0.97, 1.0)),
    (12.0, (0.96, 1.0, 1.03)),
    (10.0, (1.0, 1.03, 0.97)),
)


class NotAtHandError(InputError):
    """The data of a task are not there."""


def task_data(
    name: str,
    size: str,
    folder: Path,
    given: Path | None,
    *,
    progress: Progress = no_progress,
) -> "TaskData | ShiftData":
    """Return a task's data; those that are simulated here go into a folder.

    Parameters
    ----------
    name, size : str
        A row of ``TASKS`` and a size.
    folder : path
        Where simulations are, or are to be.
    given : path or None
        The user's data, for size ``full``.
    progress : callable
        Called with the paths solved.

    Raises
    ------
    NotAtHandError
        If the data are not there.
    InputError
        If they are others than the task's.
    """
    from physgnn.evaluation.benchmark.job import TaskData
    from physgnn.evaluation.benchmark.tasks import TASKS

    task = TASKS[name]
    if task.measured:
        family = _family(name, size, folder, given, progress)
        return shift_data(name, size, folder, tuple(family), progress=progress)
    if size == "tiny":
        stores = _tiny(name, task, folder, progress)
    else:
        stores = _full(name, task, folder, _found(task, given), progress)
    *others, tested = stores
    if task.split == MESH:
        none = np.empty((0, 2), dtype=np.int64)
        split = Split(MESH, none, none, tested.samples())
    else:
        split = named_split(task.split, tested)
    return TaskData(name, size, tested, split.thinned(HELD_OUT), tuple(others))


def _family(
    name: str, size: str, folder: Path, given: Path | None, progress: Progress
) -> list[Store]:
    """Return other bodies' datasets for a registration, if a network can use them."""
    from physgnn.evaluation.benchmark.tasks import TASKS

    task = TASKS[name]
    if not task.preset:
        return []
    if size == "tiny":
        # the first of these bodies is the one that is registered: left out
        stores = _tiny(MESH_TASK, TASKS[MESH_TASK], folder, progress)
        return stores[1:]
    return _trained(_found(task, given), task.preset)


def _found(task: "Task", given: Path | None) -> Path:
    """Return where the data of a task lie in the user's folder."""
    if given is None:
        raise NotAtHandError(f"it needs {task.needs} in the folder of --data")
    if not given.is_dir():
        raise InputError(f"{given} must be a folder of data, and it is not there")
    found = given / task.needs
    if not found.exists():
        raise NotAtHandError(f"it needs {task.needs}, which is not in {given}")
    return found


def _full(
    name: str, task: "Task", folder: Path, found: Path, progress: Progress
) -> list[Store]:
    if name == "tonutti-2017":
        from physgnn.evaluation.benchmark.tasks import TONUTTI

        return [_simulated(read_tonutti(found), TONUTTI, folder / name, progress)]
    if task.split != MESH:
        return [_checked(found, task.preset)]
    if not (found / UNSEEN).exists():
        raise NotAtHandError(f"{found} must hold {UNSEEN}, and it does not")
    trained = _trained(found, task.preset)
    return [*trained, _checked(found / UNSEEN, task.preset)]


def _trained(found: Path, preset: str) -> list[Store]:
    """Return the datasets of the bodies that training has."""
    paths = sorted((found / TRAINED).glob("*.zarr"))
    if len(paths) < 2:
        raise NotAtHandError(
            f"{found} must hold two datasets or more in {TRAINED}/ (got {len(paths)})"
        )
    return [_checked(path, preset) for path in paths]


def _checked(path: Path, preset: str) -> Store:
    """Open a dataset, and see that it is the task's."""
    store = Store.open(path, cache_bytes=128 * 2**20)
    made_with = store.provenance.get("preset")
    if made_with != preset:
        raise InputError(
            f"{path} must be simulated with --preset {preset} (got {made_with}): "
            "give the dataset that the task is about"
        )
    if len(pending := store.pending()):
        raise InputError(
            f"{path} lacks {len(pending)} of {store.n_paths} load paths: finish it "
            "with physgnn simulate"
        )
    return store


def _tiny(name: str, task: "Task", folder: Path, progress: Progress) -> list[Store]:
    preset = task.tiny
    assert preset is not None  # every task that runs has one
    bodies = BODIES if task.split == MESH else BODIES[:1]
    return [
        _simulated(_small_brain(*body), preset, folder / f"{name}-tiny-{i}", progress)
        for i, body in enumerate(bodies)
    ]


def _small_brain(radius_mm: float, scale: tuple[float, float, float]) -> TetMesh:
    phantom = mni152_phantom(n_points=SURFACE_POINTS, tumour_radius_mm=radius_mm)
    mesh = mesh_surfaces(
        phantom.brain, phantom.tumours, max_volume_mm3=LARGEST_CELL_MM3
    )
    return replace(mesh, points=mesh.points * np.array(scale))


def _simulated(mesh: TetMesh, preset: Preset, path: Path, progress: Progress) -> Store:
    path.parent.mkdir(parents=True, exist_ok=True)
    store, _ = simulate_mesh(
        mesh,
        preset,
        path.with_name(f"{path.name}.zarr"),
        workers=1 if path.name.find("-tiny-") > 0 else processes(),
        source={"command": "physgnn benchmark"},
        progress=progress,
    )
    return store


def read_tonutti(file: Path) -> TetMesh:
    """Read the mesh of Tonutti et al. 2017 with its fixed and loaded points.

    Parameters
    ----------
    file : path
        Arrays ``points`` (mm), ``cells``, ``region`` (1 the tumour), ``fixed`` and
        ``force_points``.

    Raises
    ------
    InputError
        If an array is missing or cannot be used.
    """
    arrays: Mapping[str, np.ndarray] = read_npz(file)
    with reading(file, "the mesh of Tonutti et al. 2017"):
        names = ("points", "cells", "region", "fixed", "force_points")
        missing = [name for name in names if name not in arrays]
        if missing:
            raise InputError(f"array '{missing[0]}' is missing")
        whole = partial(_whole, arrays)
        return TetMesh(
            real_numbers(arrays["points"], "points"),
            whole("cells"),
            whole("region"),
            point_sets={"fixed": whole("fixed"), "loaded": whole("force_points")},
        )


def _whole(arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    return whole_numbers(arrays[name], name)
