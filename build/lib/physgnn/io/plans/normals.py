"""Normals of a model that moved, for whatever in a file has one."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.array_checks import checked_indices
from physgnn.geometry.normals import area_vectors


def normals_at(
    points: FloatArray, triangles: IntArray, corners: IntArray, n: int
) -> FloatArray:
    """Return the unit normals of n things that corners of triangles name.

    Each is the mean of the normals of the triangles that name it, weighted by their
    areas; zero if none does.

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    triangles : (m, 3) integer array
        Indices of points.
    corners : (m, 3) integer array
        What the normals are of: those points, for normals at points, or indices of
        normals where a file counts them apart. −1 names nothing.
    n : int
        How many there are.

    Raises
    ------
    InputError
        If a triangle names a point that is not there.
    """
    checked_indices(triangles, len(points), "faces", corners=3)
    total = np.zeros((n, 3))
    areas = area_vectors(points, triangles.astype(np.int32))
    named = corners >= 0
    rows = np.broadcast_to(np.arange(len(triangles))[:, None], corners.shape)
    np.add.at(total, corners[named], areas[rows[named]])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    unit: FloatArray = total / np.where(length > 0, length, 1.0)
    return unit
