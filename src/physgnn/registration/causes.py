"""What physiology says may move a brain: gravity, swelling, a cavity that collapses.

An atlas of shifts computed beforehand holds such causes (Miga et al., "Modeling of
retraction and resection for intraoperative updating of images", Neurosurgery 49, 2001,
75–85; Dumpuri, Thompson, Dawant, Cao & Miga, "An atlas-based method to compensate for
brain shift: preliminary results", Medical Image Analysis 11, 2007, 128–145). Here each
is a family of load modes in the prior, whose size the measurement decides, beside the
families that stand for all else (`physgnn.registration.load_families`).

A cause is a row of `CAUSES`: from a body to the forces or the growth it may mean, or to
nothing where the body lacks what it acts on.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.regions import BRAIN, TUMOUR, VENTRICLE
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.gravity import submerged_volumes
from physgnn.mechanics.loads.growth_rules import cells_near

CAVITY = "cavity"
"""The point set of a resection's walls."""
NEAR_MM = 20.0  # of a tumour or its cavity: where oedema usually lies
TILT_DEG = 30.0  # of gravity from straight into the opening
LEVELS = (0.25, 0.5, 0.75)  # of the body's height, where the fluid may stand


@dataclass(frozen=True, eq=False)
class CauseModes:
    """What a cause may do to one body, up to size and sign.

    Attributes
    ----------
    forces : (n, n_points, 3) array
        Dead forces, of any scale.
    growth : (m, n_cells) array
        Changes of the volume ratio, of any scale.
    """

    forces: FloatArray
    growth: FloatArray


MakeModes = Callable[[TetMesh, IntArray], CauseModes | None]


def gravity_modes(mesh: TetMesh, free: IntArray) -> CauseModes | None:
    """Weight of what lies above the fluid, for several directions and levels.

    Tissue under the fluid's level weighs nothing. The directions are that into the
    opening, as a head is usually laid, and four that lean from it.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    free : integer array
        Points of the surface that are not at the skull.
    """
    inward = _into_opening(mesh, free)
    if inward is None:
        return None
    forces = [
        _weight_above(mesh, down, level)
        for down in _leaning(inward)
        for level in LEVELS
    ]
    return CauseModes(np.stack(forces), _none(mesh))


def near_swelling(mesh: TetMesh, free: IntArray) -> CauseModes | None:
    """Swelling or contraction of the tissue around a tumour, or around its cavity."""
    del free
    if (mesh.region == TUMOUR).any():
        middle = np.unique(mesh.cells[mesh.region == TUMOUR])
    elif CAVITY in mesh.point_sets:
        middle = mesh.point_set(CAVITY)
    else:
        return None
    near = cells_near(mesh, middle, NEAR_MM) & (mesh.region == BRAIN)
    return _growing(mesh, near)


def brain_swelling(mesh: TetMesh, free: IntArray) -> CauseModes | None:
    """Swelling or contraction of all brain tissue, as by mannitol."""
    del free
    return _growing(mesh, mesh.region == BRAIN)


def collapse_modes(mesh: TetMesh, free: IntArray) -> CauseModes | None:
    """Traction along the normal of a cavity's walls: even, and from side to side."""
    del free
    if CAVITY not in mesh.point_sets:
        return None
    faces = boundary_faces(mesh)
    wall = faces[np.isin(faces, mesh.point_set(CAVITY)).all(axis=1)]
    if not len(wall):
        return None
    area = area_vectors(mesh.points, wall)
    centres = mesh.points[wall].mean(axis=1)
    away = centres - centres.mean(axis=0)
    away /= max(float(np.abs(away).max()), 1e-12)
    shares = [np.ones(len(wall)), *away.T]
    forces = np.zeros((len(shares), mesh.n_points, 3))
    for force, share in zip(forces, shares, strict=True):
        np.add.at(force, wall, (share[:, None] * area / 3)[:, None])
    return CauseModes(forces, _none(mesh))


CAUSES: Mapping[str, MakeModes] = {
    "gravity": gravity_modes,
    "near-swelling": near_swelling,
    "brain-swelling": brain_swelling,
    "collapse": collapse_modes,
}
"""Every cause by its name; one that the body has nothing for returns None."""


def modes_of_causes(
    mesh: TetMesh, free: IntArray, names: Sequence[str] | None
) -> dict[str, CauseModes]:
    """Return the modes of causes on a body.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    free : integer array
        Points of the surface that are not at the skull.
    names : sequence of str or None
        Rows of `CAUSES`; None takes all that the body has the sets for.

    Raises
    ------
    InputError
        If there is no such row, or the body lacks what a named one acts on.
    """
    found = {}
    for name in CAUSES if names is None else names:
        if name not in CAUSES:
            raise InputError(
                f"a cause must be one of {', '.join(CAUSES)} (got '{name}')"
            )
        modes = CAUSES[name](mesh, free)
        if modes is not None:
            found[name] = modes
        elif names is not None:
            raise InputError(
                f"the body has nothing that '{name}' acts on: leave this cause out"
            )
    return found


def _growing(mesh: TetMesh, cells: BoolArray) -> CauseModes | None:
    if not cells.any():
        return None
    none = np.empty((0, mesh.n_points, 3))
    return CauseModes(none, cells.astype(np.float64)[None])


def _none(mesh: TetMesh) -> FloatArray:
    return np.empty((0, mesh.n_cells))


def _into_opening(mesh: TetMesh, free: IntArray) -> FloatArray | None:
    """Return the unit vector into the free surface, by its area."""
    faces = boundary_faces(mesh)
    open_faces = faces[np.isin(faces, free).all(axis=1)]
    inward = -area_vectors(mesh.points, open_faces).sum(axis=0)
    length = float(np.linalg.norm(inward))
    return inward / length if length > 0 else None


def _leaning(axis: FloatArray) -> list[FloatArray]:
    """Return an axis, and four directions that lean from it."""
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    along, across = np.cos(np.deg2rad(TILT_DEG)), np.sin(np.deg2rad(TILT_DEG))
    sides = (side, -side, other, -other)
    return [axis, *(along * axis + across * one for one in sides)]


def _weight_above(mesh: TetMesh, down: FloatArray, level: float) -> FloatArray:
    """Return forces down on what lies above a level, a fraction of the height."""
    height = -mesh.points @ down
    at = height.min() + level * (height.max() - height.min())
    dry = mesh.cell_volumes - submerged_volumes(mesh.points, mesh.cells, at - height)
    dry[mesh.region == VENTRICLE] = 0.0  # its fluid drains, too
    on_points = np.bincount(
        mesh.cells.ravel(), weights=np.repeat(dry / 4, 4), minlength=mesh.n_points
    )
    force: FloatArray = on_points[:, None] * down
    return force
