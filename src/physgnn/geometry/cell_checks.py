"""How the cells of a mesh may hang together, and what compiled code would fault on.

A point of no cell leaves an empty row in the tangent, on which MKL Pardiso faults. Two
cells on one side of a face overlap: one of them comes twice, or the mesh is torn.
"""

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError

Indices = NDArray[np.int32] | IntArray

# The faces of a positive tetrahedron, counter-clockwise seen from outside.
CELL_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
SHOWN = 5
"""How many of the points or cells at fault a message names."""


def check_corners(cells: Indices) -> None:
    """Raise InputError if a cell has the same point at two corners."""
    a, b, c, d = cells.T
    again = (a == b) | (a == c) | (a == d) | (b == c) | (b == d) | (c == d)
    if again.any():
        bad = int(np.flatnonzero(again)[0])
        raise InputError(
            f"cells must have four different points ({again.sum()} do not, the first "
            f"is cell {bad} with {cells[bad].tolist()}): remove them"
        )


def check_volumes(volumes: FloatArray) -> None:
    """Raise InputError if a cell has no volume, or is inside out."""
    positive = volumes > 0
    if not positive.all():
        bad = int(np.flatnonzero(~positive)[0])
        raise InputError(
            "cells must have positive volume "
            f"(cell {bad} has {volumes[bad]:.3g} mm³); "
            "swap two of its points or remove it"
        )


def unused_points(cells: Indices, n_points: int) -> IntArray:
    """Return the points that no cell has, ascending."""
    used = np.zeros(n_points, dtype=np.bool_)
    used[cells.ravel()] = True
    return np.flatnonzero(~used)


def check_used(points: FloatArray, cells: Indices) -> None:
    """Raise InputError if a point belongs to no cell."""
    unused = unused_points(cells, len(points))
    if len(unused) == 0:
        return
    more = ", …" if len(unused) > SHOWN else ""
    x, y, z = points[unused[0]]
    raise InputError(
        f"every point must belong to a cell ({len(unused)} do not: "
        f"{', '.join(map(str, unused[:SHOWN]))}{more}; the first at ({x:.1f}, {y:.1f}, "
        f"{z:.1f}) mm): merge points that coincide, and drop the others, for instance "
        "with physgnn.geometry.without_unused_points"
    )


def check_faces(cells: Indices) -> None:
    """Raise InputError if two cells lie on the same side of a face.

    Then they overlap, be it that one cell comes twice or that a face has three. The
    sides are told apart by the sense in which the corners run. Faces are compared by
    a number made of their corners, then, if two agree, by the corners themselves.
    """
    keys = _face_keys(cells)
    ordered = np.sort(keys)
    if not (ordered[1:] == ordered[:-1]).any():
        return
    faces: Indices = _turned(cells[:, CELL_FACES].reshape(-1, 3))
    _, first, index = np.unique(faces, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[index.reshape(-1)] != np.arange(len(faces)))
    if len(again) == 0:
        return
    one, two = int(first[index.reshape(-1)[again[0]]]) // 4, int(again[0]) // 4
    same = set(cells[one].tolist()) == set(cells[two].tolist())
    raise InputError(
        f"cells {one} and {two} are the same: remove one"
        if same
        else f"cells {one} and {two} overlap (both lie on the same side of face "
        f"{faces[again[0]].tolist()}): a face belongs to two cells at most"
    )


def _face_keys(cells: Indices, *, sided: bool = True) -> NDArray[np.uint64]:
    """Return a number for every face of every cell, equal if its corners are.

    And, if that is asked for, if the cells lie on the same side; (4 n_cells,), the
    first faces of all cells first.

    The sum of scrambled indices (splitmix64, Steele, Lea and Flood, OOPSLA 2014) does
    not depend on the order of the corners; the sense in which they run adds one.
    """
    scrambled = np.arange(int(cells.max()) + 1, dtype=np.uint64)
    scrambled = (scrambled + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        scrambled = (scrambled ^ (scrambled >> np.uint64(shift))) * np.uint64(factor)
    scrambled ^= scrambled >> np.uint64(31)
    keys = np.empty((4, len(cells)), dtype=np.uint64)
    at_corner = scrambled[cells.T]
    for key, (i, j, k) in zip(keys, CELL_FACES, strict=True):
        a, b, c = cells[:, i], cells[:, j], cells[:, k]
        key[:] = at_corner[i] + at_corner[j] + at_corner[k]
        if sided:
            key += (a > b) ^ (b > c) ^ (a > c)
    return keys.ravel()


def _turned(faces: Indices) -> Indices:
    """Return the faces begun at their smallest corner, in the same sense."""
    start = faces.argmin(axis=1)[:, None]
    turned: Indices = faces[np.arange(len(faces))[:, None], (start + np.arange(3)) % 3]
    return turned


def connected_cells(cells: Indices) -> IntArray:
    """Return the part each cell belongs to, from 0; a part shares whole faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    keys = _face_keys(cells, sided=False)
    order = np.argsort(keys)
    same = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
    one, two = order[same] % len(cells), order[same + 1] % len(cells)
    links = coo_array((np.ones(len(one), np.int8), (one, two)), (len(cells),) * 2)
    part: IntArray = connected_components(links, directed=False)[1].astype(np.int64)
    return part
