"""How far each measured place lies from the brain, before and after registration."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv

from physgnn.arrays import FloatArray
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.measured import BonePoints, PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.point_displacement import displacement_at

Measured = PointPairs | SurfacePoints
Undone = Callable[[FloatArray], FloatArray]
NO_FADE_MM = 1e6  # a point near the surface moves as the surface does


@dataclass(frozen=True)
class MeasuredPlace:
    """One measured place.

    Attributes
    ----------
    name : str
        Its label, or its number.
    position_mm : tuple of float
        Where it was measured, without an offset that was corrected, RAS+.
    before_mm, after_mm : float
        Its distance from the brain at rest and from the registered one: of a pair
        from its partner, of a surface from the nearest place; of the bone from its
        place in the scan, with the offset of the navigation and without.
    note : str
        What else there is to say, such as that it is an outlier.
    """

    name: str
    position_mm: tuple[float, float, float]
    before_mm: float
    after_mm: float
    note: str = ""


def measured_places(
    mesh: TetMesh,
    displacement: FloatArray,
    measured: Measured | Sequence[Measured],
    undone: Undone = np.asarray,
) -> tuple[MeasuredPlace, ...]:
    """Return every measured place with its distances, in the order they were given.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        As registered, mm.
    measured : PointPairs, BonePoints, SurfacePoints, or several
        What was measured.
    undone : callable
        Takes an offset of the navigation that was corrected out of points (n, 3).
    """
    each = measured if isinstance(measured, Sequence) else [measured]
    found = [_distances(mesh, displacement, one, undone) for one in each]
    where, before, after = (np.concatenate(part) for part in zip(*found, strict=True))
    return tuple(
        MeasuredPlace(str(i + 1), (float(x), float(y), float(z)), float(b), float(a))
        for i, ((x, y, z), b, a) in enumerate(zip(where, before, after, strict=True))
    )


def _distances(
    mesh: TetMesh, displacement: FloatArray, measured: Measured, undone: Undone
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where it was measured, and the distances before and after."""
    if isinstance(measured, BonePoints):
        where = undone(measured.target)
        before = np.linalg.norm(measured.displacement, axis=1)
        after = np.linalg.norm(where - measured.source, axis=1)
    elif isinstance(measured, PointPairs):
        where = undone(measured.target)
        went = where - measured.source
        before = np.linalg.norm(went, axis=1)
        moved = displacement_at(
            mesh, displacement, measured.source, fade_mm=NO_FADE_MM
        ).vectors
        after = np.linalg.norm(went - moved, axis=1)
    else:
        where = undone(measured.points)
        before = _from_surface(mesh, mesh.points, where)
        after = _from_surface(mesh, mesh.points + displacement, where)
    return where, before, after


def _from_surface(mesh: TetMesh, points: FloatArray, places: FloatArray) -> FloatArray:
    faces = boundary_faces(mesh).astype(int)
    surface = pv.PolyData.from_regular_faces(points, faces)
    _, nearest = surface.find_closest_cell(places, return_closest_point=True)
    distance: FloatArray = np.linalg.norm(places - np.atleast_2d(nearest), axis=1)
    return distance
