"""Pressure on a surface, normal to it wherever it goes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.tetmesh import TetMesh


@dataclass(frozen=True, eq=False)
class SurfacePressure:
    """A uniform pressure that follows the surface as it deforms.

    Every face carries −p a in its three corners alike, a its current area vector.

    Parameters
    ----------
    faces : (n_faces, 3) integer array
        Points of the mesh, counter-clockwise seen from outside; see `faces_within`.
    pressure_pa : float
        At load factor 1, Pa; positive pushes into the body.

    Raises
    ------
    InputError
        If there are no faces, or the pressure is zero or not finite.
    """

    faces: IntArray
    pressure_pa: float

    def __post_init__(self) -> None:
        faces = checked_indices(self.faces, None, "faces", corners=3)
        if not np.isfinite(self.pressure_pa) or self.pressure_pa == 0:
            raise InputError(
                f"pressure_pa must be finite and not 0 (got {self.pressure_pa})"
            )
        object.__setattr__(self, "faces", faces)

    def check_against(self, mesh: TetMesh) -> None:
        """Raise InputError if a face names a point that the mesh has not."""
        checked_indices(self.faces, mesh.n_points, "faces", corners=3)

    def bind(self, mesh: TetMesh) -> Callable[[FloatArray, float], FloatArray]:
        """Return force(u, load factor), (n_points, 3), N."""

        def force(u: FloatArray, load_factor: float) -> FloatArray:
            area = area_vectors(mesh.points + u, self.faces)
            at_corner = -1e-6 * self.pressure_pa * load_factor * area / 3
            total = np.zeros_like(u)
            np.add.at(total, self.faces, at_corner[:, None])
            return total

        return force


def faces_within(mesh: TetMesh, points: str | IntArray) -> NDArray[np.int32]:
    """Return the outer faces whose three points are all in a set, outward.

    Parameters
    ----------
    mesh : TetMesh
    points : str or integer array
        Name of a point set, or point indices.

    Returns
    -------
    (n_faces, 3) array of int32
        Point indices, counter-clockwise seen from outside.

    Raises
    ------
    InputError
        If no face qualifies.
    """
    chosen = np.zeros(mesh.n_points, dtype=bool)
    chosen[
        mesh.point_set(points)
        if isinstance(points, str)
        else checked_indices(points, mesh.n_points, "points of the surface")
    ] = True
    faces = boundary_faces(mesh)
    inside: NDArray[np.int32] = faces[chosen[faces].all(axis=1)]
    if len(inside) == 0:
        raise InputError(
            "no outer face has all its points in the set: it may lie inside the body "
            "or hold single points"
        )
    return inside
