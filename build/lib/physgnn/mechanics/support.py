"""Whether the fixed points hold every part of a body: else its tangent is singular.

A part is what hangs together by whole faces. It is held by three points that are not
in line, fixed ones or ones of a part that is held: over a shared edge or point alone
it turns like a door. Parts that only hold each other, as bars of a truss do, count as
free, though some of them are not.
"""

import numpy as np

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.cell_checks import connected_cells
from physgnn.geometry.tetmesh import TetMesh

# Points whose distance from a line is below this fraction of their spread are in line.
IN_LINE = 1e-9


def check_held(mesh: TetMesh, fixed: IntArray) -> None:
    """Raise InputError if a part of the mesh can move while the fixed points rest.

    Parameters
    ----------
    mesh : TetMesh
    fixed : (n_fixed,) integer array
        Points whose place is given: fixed ones, and those of prescribed displacement.
    """
    if len(fixed) < 3:
        raise InputError(
            f"at least three points must be fixed (got {len(fixed)}): "
            "otherwise the body floats away"
        )
    part = connected_cells(mesh.cells)
    free = free_parts(mesh, fixed, part)
    if len(free) == 0:
        return
    sizes = np.bincount(part)[free]
    cells = mesh.cells[part == free[sizes.argmax()]]
    x, y, z = mesh.points[cells].mean(axis=(0, 1))
    n_fixed = np.isin(np.unique(cells), fixed).sum()
    raise InputError(
        f"the fixed points must hold the whole mesh ({len(free)} of its "
        f"{part.max() + 1} parts can move; the largest has {len(cells)} cells near "
        f"({x:.1f}, {y:.1f}, {z:.1f}) mm and {n_fixed} fixed points): fix three points "
        "of each part that are not in line, or merge points that coincide"
    )


def free_parts(mesh: TetMesh, fixed: IntArray, part: IntArray) -> IntArray:
    """Return the parts that fixed points do not hold, directly or through others.

    Parameters
    ----------
    mesh : TetMesh
    fixed : (n_fixed,) integer array
    part : (n_cells,) integer array
        The part of each cell, from 0.

    Returns
    -------
    integer array
        Numbers of parts, ascending.
    """
    n_parts = int(part.max()) + 1
    at_rest = np.zeros(mesh.n_points, dtype=np.bool_)
    at_rest[fixed] = True
    owner, point = _points_of_parts(mesh, part)
    held = np.zeros(n_parts, dtype=np.bool_)
    while True:
        supports = np.bincount(owner[at_rest[point]], minlength=n_parts)
        candidates = np.flatnonzero(~held & (supports >= 3))
        found = [
            p
            for p in candidates.tolist()
            if _holds(mesh, _of(owner, point, p), at_rest)
        ]
        if not found:
            return np.flatnonzero(~held)
        held[found] = True
        at_rest[point[held[owner]]] = True


def _points_of_parts(mesh: TetMesh, part: IntArray) -> tuple[IntArray, IntArray]:
    """Return every pair of part and point once, sorted by the part."""
    if not part.any():
        return np.zeros(mesh.n_points, dtype=np.int64), np.arange(mesh.n_points)
    pairs = np.unique(np.repeat(part, 4) * mesh.n_points + mesh.cells.ravel())
    return pairs // mesh.n_points, pairs % mesh.n_points


def _of(owner: IntArray, point: IntArray, part: int) -> IntArray:
    return point[slice(*np.searchsorted(owner, [part, part + 1]))]


def _holds(mesh: TetMesh, points: IntArray, at_rest: BoolArray) -> bool:
    """Whether those of the points that are at rest are not all in line."""
    return not _in_line(mesh.points[points[at_rest[points]]])


def _in_line(points: FloatArray) -> bool:
    spread = points - points.mean(axis=0)
    widths = np.linalg.svd(spread.T @ spread, compute_uv=False)
    return bool(widths[1] <= IN_LINE**2 * widths[0])
