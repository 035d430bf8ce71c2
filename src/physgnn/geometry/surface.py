"""Triangulated surfaces: the domain type that meshing starts from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError

FaceArray = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in space.

    Parameters
    ----------
    points : (n_points, 3) array
        Coordinates in mm, world axes RAS+.
    faces : (n_faces, 3) integer array
        Point indices, counter-clockwise seen from outside. That a surface is
        closed and faces outward is what `check_surface` is for.

    Raises
    ------
    InputError
        If the surface is empty, a coordinate is not finite or an index is not
        that of a point.
    """

    points: FloatArray
    faces: FaceArray

    def __post_init__(self) -> None:
        points = np.ascontiguousarray(self.points, dtype=np.float64)
        faces = np.ascontiguousarray(self.faces, dtype=np.int32)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "faces", faces)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
            raise InputError(
                "a surface needs points of shape (n_points, 3), n_points ≥ 1 "
                f"(got {points.shape})"
            )
        if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0:
            raise InputError(
                "a surface needs faces of shape (n_faces, 3), n_faces ≥ 1 "
                f"(got {faces.shape})"
            )
        if not np.isfinite(points).all():
            bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
            raise InputError(
                f"surface points must be finite (point {bad} is {points[bad]})"
            )
        if faces.min() < 0 or faces.max() >= len(points):
            raise InputError(
                f"surface faces must index 0…{len(points) - 1} "
                f"(got {faces.min()}…{faces.max()})"
            )

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.faces)

    def flipped(self) -> "Surface":
        """Return the surface with every face turned over."""
        return Surface(self.points, self.faces[:, ::-1])


def volume(surface: Surface) -> float:
    """Return the enclosed volume in mm³, negative if the faces point inward.

    The divergence theorem over tetrahedra from the surface's first point, which
    keeps the digits of a small surface far from the origin.
    """
    a, b, c = np.moveaxis((surface.points - surface.points[0])[surface.faces], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def edges(surface: Surface) -> FaceArray:
    """Return every undirected edge once, shape (n_edges, 2), smaller index first."""
    unique: FaceArray = np.unique(np.sort(directed_edges(surface.faces), 1), axis=0)
    return unique


def edge_lengths(surface: Surface) -> FloatArray:
    """Return the length of every undirected edge in mm, shape (n_edges,)."""
    start, end = surface.points[edges(surface)].transpose(1, 0, 2)
    lengths: FloatArray = np.linalg.norm(end - start, axis=1)
    return lengths


def directed_edges(faces: FaceArray) -> FaceArray:
    """Return the edges as the faces run through them, shape (3 n_faces, 2)."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def merge(surfaces: list[Surface]) -> Surface:
    """Return the surfaces as one, points sorted by (x, y, z) and each kept once."""
    starts = np.cumsum([0, *(surface.n_points for surface in surfaces)])
    faces = [
        surface.faces + start for surface, start in zip(surfaces, starts, strict=False)
    ]
    points = np.concatenate([surface.points for surface in surfaces])
    return merge_points(points, np.concatenate(faces))


def merge_points(points: FloatArray, faces: FaceArray) -> Surface:
    """Return a surface in which equal points are one, sorted by (x, y, z)."""
    surface = Surface(points, faces)
    unique, index = np.unique(surface.points, axis=0, return_inverse=True)
    return Surface(unique, index.reshape(-1)[surface.faces].astype(np.int32))
