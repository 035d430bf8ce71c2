"""Triangulated surfaces: the domain type that meshing starts from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.geometry.array_checks import checked_indices, checked_points

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
        If the surface is empty, a coordinate is not finite and real, or an index is
        not the integer index of a point.
    """

    points: FloatArray
    faces: FaceArray

    def __post_init__(self) -> None:
        points = checked_points(self.points, "surface points")
        faces = checked_indices(self.faces, len(points), "faces", corners=3)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "faces", np.ascontiguousarray(faces, dtype=np.int32))

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

    Parameters
    ----------
    surface : Surface
        Closed triangles, counter-clockwise seen from outside; mm.

    Returns
    -------
    float
        mm³.
    """
    a, b, c = np.moveaxis((surface.points - surface.points[0])[surface.faces], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def edges(surface: Surface) -> FaceArray:
    """Return every undirected edge once, shape (n_edges, 2), smaller index first.

    Parameters
    ----------
    surface : Surface
        Triangles, counter-clockwise seen from outside; mm.

    Returns
    -------
    (n_edges, 2) array of int32
        Point indices, sorted.
    """
    unique: FaceArray = np.unique(np.sort(directed_edges(surface.faces), 1), axis=0)
    return unique


def edge_lengths(surface: Surface) -> FloatArray:
    """Return the length of every undirected edge in mm, shape (n_edges,).

    Parameters
    ----------
    surface : Surface
        Triangles, counter-clockwise seen from outside; mm.

    Returns
    -------
    (n_edges,) array
        mm, in the order of `edges`.
    """
    start, end = surface.points[edges(surface)].transpose(1, 0, 2)
    lengths: FloatArray = np.linalg.norm(end - start, axis=1)
    return lengths


def directed_edges(faces: FaceArray) -> FaceArray:
    """Return the edges as the faces run through them, shape (3 n_faces, 2)."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def merge(surfaces: list[Surface]) -> Surface:
    """Return the surfaces as one, points sorted by (x, y, z) duplicates removed.

    Parameters
    ----------
    surfaces : list of Surface
        In mm, one at least.

    Returns
    -------
    Surface
        All of their faces, in their order.
    """
    starts = np.cumsum([0, *(surface.n_points for surface in surfaces)])
    faces = [
        surface.faces + start for surface, start in zip(surfaces, starts, strict=False)
    ]
    points = np.concatenate([surface.points for surface in surfaces])
    return merge_points(points, np.concatenate(faces))


def merge_points(points: FloatArray, faces: FaceArray) -> Surface:
    """Return a surface in which equal points are one, sorted by (x, y, z).

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    faces : (n_faces, 3) array of int
        Indices of points.

    Returns
    -------
    Surface
        The same faces over points that differ.
    """
    surface = Surface(points, faces)
    unique, index = np.unique(surface.points, axis=0, return_inverse=True)
    return Surface(unique, index.reshape(-1)[surface.faces].astype(np.int32))
