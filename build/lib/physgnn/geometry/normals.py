"""Normals of faces and points."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.surface import FaceArray, Surface


def face_normals(surface: Surface) -> FloatArray:
    """Return the outward unit normal of every face, shape (n_faces, 3).

    A face without area has the zero vector.

    Parameters
    ----------
    surface : Surface
        Triangles, counter-clockwise seen from outside; mm.

    Returns
    -------
    (n_faces, 3) array
        Unit vectors, without a unit of measure.
    """
    return _unit(area_vectors(surface.points, surface.faces))


def vertex_normals(surface: Surface) -> FloatArray:
    """Return the outward unit normal of every point, shape (n_points, 3).

    The mean of the unit normals of the adjacent faces, made a unit vector again,
    which is what the published loads were built with; its negative points into
    the tissue. A point of no face has the zero vector.

    Parameters
    ----------
    surface : Surface
        Triangles, counter-clockwise seen from outside; mm.

    Returns
    -------
    (n_points, 3) array
        Unit vectors.
    """
    total = np.zeros_like(surface.points)
    np.add.at(total, surface.faces, face_normals(surface)[:, None, :])
    return _unit(total)


def area_vectors(points: FloatArray, faces: FaceArray | IntArray) -> FloatArray:
    """Return the normal of every face with its area for length, shape (n_faces, 3)."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    vectors: FloatArray = 0.5 * np.cross(b - a, c - a)
    return vectors


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)
