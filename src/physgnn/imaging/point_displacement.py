"""The displacement at points anywhere: forward, as plans and models need it.

Points X move to X + u(X), images the other way (`physgnn.imaging.field`). Inside of a
tetrahedron u is linear. Outside of the brain the displacement of the nearest place on
its surface fades to zero along a straight line, over the same length as in images.
"""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.field import checked_displacement, fade_length
from physgnn.imaging.scattered_fields import interpolated

TOLERANCE_MM = 1e-9  # as near to the surface as rounding allows


@dataclass(frozen=True, eq=False)
class PointDisplacement:
    """How points move, and which of them lie outside of the mesh.

    Attributes
    ----------
    vectors : (n, 3) array
        u, mm.
    outside_mm : (n,) array
        Distance from the mesh, 0 inside.
    fade_mm : float
        Farther outside than this nothing moves.
    """

    vectors: FloatArray
    outside_mm: FloatArray
    fade_mm: float

    @property
    def outside(self) -> BoolArray:
        """Which points are extrapolated or do not move."""
        out: BoolArray = self.outside_mm > 0
        return out


def displacement_at(
    mesh: TetMesh,
    displacement: FloatArray,
    points: FloatArray,
    *,
    fade_mm: float | None = None,
) -> PointDisplacement:
    """Return u at points.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        On the mesh's points, mm.
    points : (n, 3) array
        Anywhere, mm, RAS+.
    fade_mm : float, optional
        As of `physgnn.imaging.forward_field`.

    Raises
    ------
    InputError
        If the displacement does not fit the mesh, or no point is in or near it.
    """
    u, points = checked_displacement(mesh, displacement), np.asarray(points, np.float64)
    fade_mm = fade_length(u, fade_mm)
    vectors, inside = interpolated(mesh, u, points)
    outside_mm = np.zeros(len(points))
    away = np.flatnonzero(~inside)
    if len(away):
        nearest, distance = _on_surface(mesh, u, points[away])
        # what the locator's rounding left out lies on the surface
        outside_mm[away] = np.where(distance < TOLERANCE_MM, 0.0, distance)
        weight = np.clip(1.0 - distance / fade_mm, 0.0, 1.0)
        vectors[away] = weight[:, None] * nearest
    if (outside_mm >= fade_mm).all():
        raise InputError(
            "mesh and points do not meet (the nearest point is "
            f"{outside_mm.min():.0f} mm from the mesh): check that both are in the "
            "same world coordinates, mm"
        )
    return PointDisplacement(vectors, outside_mm, fade_mm)


def _on_surface(
    mesh: TetMesh, u: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return u at the nearest places of the mesh's surface, and their distance."""
    import pyvista as pv

    faces = boundary_faces(mesh).astype(int)
    surface = pv.PolyData.from_regular_faces(mesh.points, faces)
    cells, nearest = surface.find_closest_cell(points, return_closest_point=True)
    corners = faces[np.atleast_1d(cells)]
    weights = _barycentric(mesh.points[corners], np.atleast_2d(nearest))
    vectors: FloatArray = np.einsum("nk,nki->ni", weights, u[corners])
    distance: FloatArray = np.linalg.norm(points - nearest, axis=1)
    return vectors, distance


def _barycentric(corners: FloatArray, places: FloatArray) -> FloatArray:
    """Return weights (n, 3) of the corners (n, 3, 3) of triangles at places in them."""
    a = corners[:, 0]
    b, c, p = corners[:, 1] - a, corners[:, 2] - a, places - a
    normal = np.cross(b, c)
    square = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    of_b = (np.cross(p, c) * normal).sum(axis=1) / square
    of_c = (np.cross(b, p) * normal).sum(axis=1) / square
    return np.stack([1.0 - of_b - of_c, of_b, of_c], axis=1)
