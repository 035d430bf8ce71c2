"""Which triangles cross which: exact up to rounding, vectorised over pairs."""

from itertools import pairwise

import numpy as np

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.geometry.normals import face_normals
from physgnn.geometry.surface import Surface

CHUNK = 4_000_000


def crossing_faces(surface: Surface) -> IntArray:
    """Return the pairs of faces that meet anywhere but in shared points.

    Parameters
    ----------
    surface : Surface
        Consistently oriented, no degenerate faces.

    Returns
    -------
    (n_pairs, 2) integer array
        Face indices, smaller first. Touching counts as crossing.
    """
    pairs = box_pairs(surface.points[surface.faces])
    a, b = surface.faces[pairs[:, 0]], surface.faces[pairs[:, 1]]
    n_shared = (a[:, :, None] == b[:, None, :]).any(axis=2).sum(axis=1)
    crosses = np.zeros(len(pairs), dtype=bool)
    # Sharing an edge, two triangles overlap only if folded onto each other.
    normals = face_normals(surface)
    fold = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]])
    crosses[(n_shared == 2) & (fold < -1.0 + 1e-12)] = True
    crosses[n_shared == 3] = True
    # Sharing one point or none: with the shared point taken away from either, what
    # is left of it must not meet the other.
    open_pairs = n_shared < 2
    a, b = a[open_pairs], b[open_pairs]
    crosses[open_pairs] = _meet(surface.points, _without_shared(a, b), b) | _meet(
        surface.points, a, _without_shared(b, a)
    )
    return pairs[crosses]


def box_pairs(triangles: FloatArray) -> IntArray:
    """Return the pairs of triangles whose bounding boxes overlap, smaller first.

    Boxes sorted along x are each compared with those that begin before it ends.
    """
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    count = np.searchsorted(low[:, 0], high[:, 0], side="right")
    count -= np.arange(1, len(order) + 1)
    found = []
    for start, stop in _chunks(count):
        first = np.repeat(np.arange(start, stop), count[start:stop])
        ends = np.cumsum(count[start:stop])
        second = first + 1 + np.arange(len(first))
        second -= np.repeat(ends - count[start:stop], count[start:stop])
        overlap = (
            (low[first, 1:] <= high[second, 1:]) & (low[second, 1:] <= high[first, 1:])
        ).all(axis=1)
        found.append(np.stack([order[first[overlap]], order[second[overlap]]], axis=1))
    return np.sort(np.concatenate(found), axis=1)


def _chunks(count: IntArray) -> list[tuple[int, int]]:
    """Split rows so that each chunk has about CHUNK pairs at most."""
    total = np.concatenate([[0], np.cumsum(count)])
    starts = [0]
    while starts[-1] < len(count):
        stop = int(np.searchsorted(total, total[starts[-1]] + CHUNK, side="right")) - 1
        starts.append(min(max(stop, starts[-1] + 1), len(count)))
    return list(pairwise(starts))


def _without_shared(a: IntArray, b: IntArray) -> IntArray:
    """Replace the points of a that b has by one that it has not: edge or triangle."""
    shared = (a[:, :, None] == b[:, None, :]).any(axis=2)
    rows = np.arange(len(a))
    own = a[rows, np.argmin(shared, axis=1)]
    return np.where(shared, own[:, None], a)


def _meet(points: FloatArray, a: IntArray, b: IntArray) -> BoolArray:
    """Whether triangles meet, by the separating axis theorem.

    Convex sets are apart if and only if their projections on some axis are: a normal,
    the product of two edges, or, for sets in one plane, a normal times an edge. Edges
    and points pass as triangles with repeated corners. Each axis is tried on the
    pairs that none before it has separated.
    """
    p, q = points[a], points[b]
    origin = q[:, :1].copy()
    p, q = p - origin, q - origin
    left = np.arange(len(p))
    for first, second, plane in AXES:
        axis = _axis(p[left], q[left], first, second, plane)
        on_p = np.einsum("ijk,ik->ij", p[left], axis)
        on_q = np.einsum("ijk,ik->ij", q[left], axis)
        meet = (on_p.max(axis=1) >= on_q.min(axis=1)) & (
            on_q.max(axis=1) >= on_p.min(axis=1)
        )
        left = left[meet]
    result = np.zeros(len(p), dtype=bool)
    result[left] = True
    return result


def _axis(
    p: FloatArray, q: FloatArray, first: int, second: int, plane: int
) -> FloatArray:
    """Return edge × edge, or (edge × edge) × edge; edges 0–2 are p's, 3–5 q's."""

    def edge(i: int) -> FloatArray:
        corners, i = (p, i) if i < 3 else (q, i - 3)
        return corners[:, (i + 1) % 3] - corners[:, i]

    axis = np.cross(edge(first), edge(second))
    return axis if plane < 0 else np.cross(axis, edge(plane))


# Normals first: they separate most neighbours.
NORMALS = [(0, 1), (3, 4)]
AXES = [
    *((i, j, -1) for i, j in NORMALS),
    *((i, j, -1) for i in range(3) for j in range(3, 6)),
    *((i, j, k) for i, j in NORMALS for k in range(6)),
]
