"""Which points the approximation at a place depends on: supports and neighbours.

A place depends on all points within its support radius. The radius is a multiple of the
spacing there, and larger where it would hold too few. It belongs to the place, so that
fine and coarse parts of a mesh have about as many neighbours: a radius of the points
would reach from coarse parts far into fine ones, and smooth away what these resolve.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh

MARGIN = 1.2  # the last of the least neighbours lies so far inside: w > 0.01
EDGES = np.array(list(combinations(range(4), 2)))


@dataclass(frozen=True, eq=False)
class Neighbours:
    """The points that act on every place.

    Attributes
    ----------
    start : (n_places + 1,) int64 array
        Where each place's neighbours begin in `nodes`.
    nodes : (n_pairs,) int32 array
        Points, ascending at each place.
    """

    start: IntArray
    nodes: NDArray[np.int32]


def spacing(mesh: TetMesh) -> FloatArray:
    """Return the mean length of the edges at every point, over cells, mm."""
    pairs = mesh.cells[:, EDGES].reshape(-1, 2)
    length = np.linalg.norm(np.diff(mesh.points[pairs], axis=1)[:, 0], axis=1)
    ends, twice = pairs.T.ravel(), np.tile(length, 2)
    total = np.bincount(ends, weights=twice, minlength=mesh.n_points)
    mean: FloatArray = total / np.bincount(ends, minlength=mesh.n_points)
    return mean


def support_radii(
    points: FloatArray, places: FloatArray, *, wanted: FloatArray, least: int
) -> FloatArray:
    """Return the support radius at every place, (n_places,), mm.

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    places : (n_places, 3) array
        Where the approximation is evaluated, mm.
    wanted : (n_places,) array
        The radius where it holds enough points, mm.
    least : int
        Neighbours that every place must have, if there are so many points.
    """
    n_nearest = min(least, len(points))
    farthest, _ = cKDTree(points).query(places, k=[n_nearest])
    radii: FloatArray = np.maximum(wanted, MARGIN * farthest[:, 0])
    return radii


def neighbours(points: FloatArray, radii: FloatArray, places: FloatArray) -> Neighbours:
    """Find the points within the radius of each place.

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    radii : (n_places,) array
        mm.
    places : (n_places, 3) array
        mm.
    """
    found = cKDTree(points).query_ball_point(places, radii, return_sorted=True)
    start = np.zeros(len(places) + 1, dtype=np.int64)
    np.cumsum([len(near) for near in found], out=start[1:])
    return Neighbours(start, np.concatenate(found).astype(np.int32))
