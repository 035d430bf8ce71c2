"""How the faces of a closed surface hang together: edges, pieces, sides, pinches.

A half-edge is one edge of one face, numbered ``edge · n_faces + face`` with edge 0, 1
or 2 starting at that corner of the face. Its number is also that of its corner.
"""

import numpy as np

from physgnn.arrays import IntArray
from physgnn.geometry.surface import FaceArray, directed_edges


def edge_counts(faces: FaceArray) -> tuple[FaceArray, IntArray]:
    """Return every undirected edge once and the number of its faces."""
    edges, counts = np.unique(
        np.sort(directed_edges(faces), axis=1), axis=0, return_counts=True
    )
    return edges, counts


def orientation(faces: FaceArray) -> tuple[IntArray, IntArray]:
    """Return piece and side of every face of a surface whose edges have two faces.

    Each face is two nodes of a graph, as it is and turned over, linked to those of
    its neighbours that agree. A piece with two sides falls into two components.

    Returns
    -------
    piece : (n_faces,) integer array
        Equal for connected faces.
    side : (n_faces,) integer array
        0 and 1 for faces of a piece that disagree; −1 for a piece of one side only.
    """
    n = len(faces)
    directed = directed_edges(faces)
    one, two = _twins(faces)
    agree = directed[one, 0] == directed[two, 1]
    one, two = one % n, two % n
    start = np.concatenate([one, one + n])
    end = np.concatenate([two + n * ~agree, two + n * agree])
    as_is, turned = np.split(_components(start, end, 2 * n), 2)
    side = np.where(as_is == turned, -1, (as_is > turned).astype(np.int64))
    return np.minimum(as_is, turned), side


def pinched_points(faces: FaceArray) -> IntArray:
    """Return the points where two sheets of an oriented surface touch.

    There the corners that meet fall apart into two fans or more.
    """
    n = len(faces)
    one, two = _twins(faces)
    one_end, two_end = ((h + n) % (3 * n) for h in (one, two))
    fan = _components(
        np.concatenate([one, one_end]), np.concatenate([two_end, two]), 3 * n
    )
    _, first = np.unique(fan, return_index=True)
    points, fans = np.unique(faces.T.reshape(-1)[first], return_counts=True)
    return points[fans > 1].astype(np.int64)


def _twins(faces: FaceArray) -> tuple[IntArray, IntArray]:
    """Return the two half-edges of every edge."""
    order = np.lexsort(np.sort(directed_edges(faces), axis=1).T)
    return order[::2], order[1::2]


def _components(start: IntArray, end: IntArray, n: int) -> IntArray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(start)), (start, end)), (n, n))
    label: IntArray = connected_components(graph, directed=False)[1]
    return label.astype(np.int64)
