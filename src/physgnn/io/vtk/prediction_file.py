"""A predicted displacement read back, and the deformed body written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_points
from physgnn.geometry.boundary import boundary_faces, region_faces
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtu import (
    RAS,
    REMOVED_CELLS,
    REMOVED_POINTS,
    SPACE,
    add_notes,
    read_mesh,
)
from physgnn.io.vtk.writer import write_vtk
from physgnn.progress import Log, no_log

DISPLACEMENT = "displacement_mm"
STATE, DEFORMED = "state", "deformed"
STATUS, REASONS = "status", "reasons"  # field data: what a displacement is called, why
NAVIGATION = "navigation"  # field data: how far it is off, and what points of bone say
MOST_SIZES = 3.0  # of a body that a point of it moves by: more is another unit
USABLE = ("ok", "ok if navigation is right", "repaired", "solved")
"""Statuses that do not speak against a displacement: see
`physgnn.prediction.PredictionStatus.usable`."""


def read_displacement(
    path: str | Path, *, log: Log = no_log
) -> tuple[TetMesh, FloatArray]:
    """Read a mesh in its rest state and the displacement on its points, mm.

    Parameters
    ----------
    path : path
        VTU, as `physgnn predict` or `write_prediction` leaves it.
    log : callable
        Called with the reasons why the displacement was not called ok, if any.

    Raises
    ------
    InputError
        If it is no mesh, cannot be in mm, or has no point array ``displacement_mm``
        that its points can move by.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"{path}: no such file; make a displacement with 'physgnn predict' or "
            "'physgnn register'"
        )
    mesh = read_mesh(path)
    grid = read_vtk(Path(path))
    if STATE in grid.field_data:
        raise InputError(
            f"{path}: this body is deformed already; give the mesh at rest with its "
            "displacement, as 'physgnn predict' or 'register' writes it unless another "
            "form is asked for"
        )
    arrays = grid.point_data
    if DISPLACEMENT not in arrays or arrays[DISPLACEMENT].shape != mesh.points.shape:
        have = ", ".join(arrays) or "none"
        raise InputError(
            f"{path}: needs a point array '{DISPLACEMENT}' of three components (it "
            f"has: {have}); make it with 'physgnn predict'"
        )
    stored = _stored_status(grid)
    if not stored.usable:
        log(f"warning: {path} holds a displacement that is not ok: {stored}")
    with reading(path, "a displacement"):
        u = real_numbers(arrays[DISPLACEMENT], DISPLACEMENT)
        _check_possible(u, mesh)
        return mesh, u


def _check_possible(u: FloatArray, mesh: TetMesh) -> None:
    """Raise InputError if no body moves so."""
    wrong = np.flatnonzero(~np.isfinite(u).all(axis=1))
    if len(wrong):
        raise InputError(
            f"'{DISPLACEMENT}' must be finite ({len(wrong)} of {len(u)} points have "
            f"NaN or infinity, the first is {wrong[0]}): make it again"
        )
    largest = float(np.linalg.norm(u, axis=1).max())
    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    if largest > MOST_SIZES * size:
        raise InputError(
            f"'{DISPLACEMENT}' must be in mm (a point moves by {largest:.3g} mm, and "
            f"the body has {size:.3g} mm): make it again"
        )


@dataclass(frozen=True)
class StoredStatus:
    """What a displacement was called when it was written.

    Attributes
    ----------
    status : str
        As `physgnn.prediction.PredictionStatus` says it; empty if the file does not
        tell, as one of another program.
    reasons : tuple of str
        Why it is not ok.
    """

    status: str = ""
    reasons: tuple[str, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether nothing speaks against it."""
        return self.status in ("", *USABLE)

    def __str__(self) -> str:
        return ": ".join(filter(None, [self.status, "; ".join(self.reasons)]))


def read_status(path: str | Path) -> StoredStatus:
    """Return what a file says of the displacement in it.

    Raises
    ------
    InputError
        If it is no VTK file.
    """
    return _stored_status(read_vtk(Path(path)))


def _stored_status(data: VtkData) -> StoredStatus:
    fields = data.field_data
    if STATUS not in fields:
        return StoredStatus()
    status = " ".join(map(str, fields[STATUS]))
    return StoredStatus(status, tuple(map(str, fields.get(REASONS, ()))))


def read_removed(path: str | Path) -> TetMesh | None:
    """Return the tissue that a resection took out, at rest; None if none was.

    Parameters
    ----------
    path : path
        VTU, as `physgnn register --remove` writes it.

    Raises
    ------
    InputError
        If the file cannot be read, or its removed cells name points that it has not.
    """
    arrays = read_vtk(Path(path)).field_data
    if REMOVED_POINTS not in arrays or REMOVED_CELLS not in arrays:
        return None
    with reading(Path(path), "removed tissue"):
        points = real_numbers(arrays[REMOVED_POINTS], REMOVED_POINTS)
        points = checked_points(points, REMOVED_POINTS)
        cells = whole_numbers(arrays[REMOVED_CELLS], REMOVED_CELLS)
        if cells.ndim != 2 or cells.shape[1] != 4 or not len(cells):
            raise InputError(
                f"'{REMOVED_CELLS}' must be cells of four points (got {cells.shape})"
            )
        checked_indices(cells.ravel(), len(points), REMOVED_CELLS)
        return TetMesh(points, cells.astype(np.int32), np.ones(len(cells), np.int32))


def write_deformed(
    path: str | Path,
    mesh: TetMesh,
    displacement: FloatArray,
    *,
    notes: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Write the body where it moves to: .vtu the mesh, .vtp its surfaces.

    The point array ``displacement_mm`` leads back to the rest state; the cell array
    ``region`` says whose surface a face is, 0 that of the whole brain. Unlike a rest
    state, what is written may have cells turned inside out. Notes become field data.

    Raises
    ------
    InputError
        If the name has another suffix or the folder is missing.
    """
    import pyvista as pv

    path = Path(path)
    moved = mesh.points + displacement
    suffix = path.suffix.lower()
    if suffix == ".vtu":
        body = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, moved)
        body.cell_data["region"] = mesh.region
    elif suffix == ".vtp":
        faces, region = _surfaces(mesh)
        body = pv.PolyData.from_regular_faces(moved, faces.astype(int))
        body.cell_data["region"] = region
    else:
        raise InputError(
            f"{path}: a deformed body is written as .vtu or .vtp (got '{path.suffix}')"
        )
    body.point_data[DISPLACEMENT] = displacement
    body.field_data[STATE] = [DEFORMED]
    body.field_data[SPACE] = [RAS]
    add_notes(body, notes)
    if isinstance(body, pv.PolyData):
        body = body.clean(point_merging=False)
    write_vtk(path, body)


def _surfaces(mesh: TetMesh) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the faces of the whole body and of every region inside, and whose."""
    faces = [boundary_faces(mesh)]
    labels = [0, *np.unique(mesh.region[mesh.region > 0]).tolist()]
    faces += [region_faces(mesh, label) for label in labels[1:]]
    whose = np.repeat(labels, [len(f) for f in faces]).astype(np.int32)
    return np.concatenate(faces), whose
