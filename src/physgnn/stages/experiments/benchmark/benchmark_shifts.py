"""The shifts that registrations are measured on: simulated once, and kept."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.untrusted.compressed import read_npz
from physgnn.progress import Progress, no_progress

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.benchmark.shift_data import ShiftData
    from physgnn.evaluation.in_silico.cases import Case
    from physgnn.evaluation.in_silico.shifts import Truth


def shift_data(
    name: str,
    size: str,
    folder: Path,
    family: tuple[Store, ...],
    *,
    progress: Progress = no_progress,
) -> "ShiftData":
    """Return a registration's data; shifts that are not there are simulated.

    Parameters
    ----------
    name, size : str
        A row of ``TASKS`` and a size.
    folder : path
        Where shifts are, or are to be; both registration tasks have the same.
    family : tuple of Store
        What a network learns from.
    progress : callable
        Called with the shifts done.
    """
    from physgnn.evaluation.benchmark.shift_data import SHIFT_SIZES, ShiftData
    from physgnn.evaluation.benchmark.tasks import TASKS
    from physgnn.evaluation.in_silico.compared import Compared
    from physgnn.evaluation.in_silico.shifts import Truth

    of = SHIFT_SIZES[size]
    progress(0, of.cases, "meshing what shifts")
    truth = Truth(of.true_points, "fixed", surface_points=of.true_surface)
    cases = []
    for seed in range(of.cases):
        progress(seed, of.cases, "simulating shifts")
        cases.append(_case(truth, seed, folder / f"shifts-{size}"))
    progress(of.cases, of.cases, "meshing what is registered")
    body = Compared(of.points, "fixed", truth.mesh.points, surface_points=of.surface)
    measured = TASKS[name].measured
    return ShiftData(name, size, measured, truth, tuple(cases), body, family)


def _case(truth: "Truth", seed: int, folder: Path) -> "Case":
    """Return a shift from its file, or simulate it and write the file."""
    file = folder / f"shift-{seed:03d}.npz"
    mesh = np.frombuffer(bytes.fromhex(truth.mesh.content_hash), np.uint8)
    if file.exists():
        arrays = _read(file)
        if np.array_equal(arrays["mesh"], mesh):
            return _from_arrays(arrays)
    case = truth.case(seed)
    folder.mkdir(parents=True, exist_ok=True)
    with whole_file(file) as part, part.open("wb") as stream:
        np.savez(stream, mesh=mesh, **_arrays(case))
    return case


def _read(file: Path) -> Mapping[str, NDArray[Any]]:
    """Return the arrays of a shift's file; raise InputError if it is none."""
    try:
        arrays = read_npz(file)
    except InputError:
        arrays = {}
    if set(arrays) != {*NAMES, "mesh"}:
        raise InputError(
            f"{file} is no shift of physgnn benchmark, or damaged: delete it, and it "
            "is simulated again"
        )
    return arrays


NAMES = (
    "displacement", "pair_source", "pair_target", "surface", "landmark_source",
    "landmark_target", "whole_points", "whole_faces", "bone_source", "bone_target",
)  # fmt: skip


def _arrays(case: "Case") -> dict[str, Any]:
    values = (
        case.displacement, case.pairs.source, case.pairs.target, case.surface.points,
        case.landmarks.source, case.landmarks.target, case.whole.points,
        case.whole.faces, case.bone.source, case.bone.target,
    )  # fmt: skip
    return dict[str, Any](zip(NAMES, values, strict=True))


def _from_arrays(arrays: Mapping[str, NDArray[Any]]) -> "Case":
    from physgnn.evaluation.in_silico.cases import Case

    return Case(
        PointPairs(arrays["pair_source"], arrays["pair_target"]),
        SurfacePoints(arrays["surface"]),
        arrays["displacement"],
        Landmarks(arrays["landmark_source"], arrays["landmark_target"]),
        WholeSurface(arrays["whole_points"], arrays["whole_faces"].astype(np.int64)),
        BonePoints(arrays["bone_source"], arrays["bone_target"]),
    )
