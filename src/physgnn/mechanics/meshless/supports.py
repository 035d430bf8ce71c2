"""Which points the approximation at a place depends on: supports and neighbours.

A point acts on every place nearer than its support radius. The radius is a multiple of
the spacing there, and larger where places would have too few neighbours, so that it
belongs to the point and the approximation stays smooth.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh

MARGIN = 1.2  # a nearest neighbour lies this far inside of its radius: w > 0.01
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
    mesh: TetMesh, places: FloatArray, *, dilation: float, least: int
) -> FloatArray:
    """Return the support radius of every point, (n_points,), mm.

    Parameters
    ----------
    mesh : TetMesh
    places : (n_places, 3) array
        Where the approximation is evaluated, mm.
    dilation : float
        Radius over the mean length of the edges at a point.
    least : int
        Neighbours that every place must have, if there are so many points.
    """
    tree = cKDTree(mesh.points)
    n_nearest = min(least, mesh.n_points)
    distance, nearest = tree.query(places, k=np.arange(1, n_nearest + 1))
    reach = np.zeros(mesh.n_points)
    np.maximum.at(reach, nearest, distance)
    radii: FloatArray = np.maximum(dilation * spacing(mesh), MARGIN * reach)
    return radii


def neighbours(points: FloatArray, radii: FloatArray, places: FloatArray) -> Neighbours:
    """Find the points whose supports hold each place.

    Parameters
    ----------
    points : (n_points, 3) array
        mm.
    radii : (n_points,) array
        mm.
    places : (n_places, 3) array
        mm.
    """
    found = cKDTree(places).query_ball_point(points, radii)
    count = np.array([len(held) for held in found])
    place = np.concatenate([np.asarray(held, dtype=np.int64) for held in found])
    node = np.repeat(np.arange(len(points), dtype=np.int32), count)
    start = np.zeros(len(places) + 1, dtype=np.int64)
    np.cumsum(np.bincount(place, minlength=len(places)), out=start[1:])
    return Neighbours(start, node[np.argsort(place, kind="stable")])
