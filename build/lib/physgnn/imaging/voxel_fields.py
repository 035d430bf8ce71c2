"""Fields of a tetrahedral mesh at the voxel centres of an image.

Barycentric coordinates do not change under an affine map, so the mesh is carried into
voxel indices once; each cell then fills the voxels of its bounding box that it holds.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.geometry.image import ImageGrid

# Voxel centres on the outer surface count as inside, whatever the rounding.
TOLERANCE = 1e-9


def rasterize(
    points: FloatArray,
    cells: NDArray[np.int32],
    values: FloatArray,
    grid: ImageGrid,
) -> tuple[FloatArray, NDArray[np.int32]]:
    """Interpolate linearly within every cell.

    Parameters
    ----------
    points : (n_points, 3) array
        World coordinates, mm: those of the rest state or of a deformed one.
    cells : (n_cells, 4) integer array
        Point indices. Cells turned inside out are left out.
    values : (n_points, n) array
        What to interpolate.
    grid : ImageGrid
        Where to.

    Returns
    -------
    field : (nx, ny, nz, n) array
        The values; 0 outside of the mesh.
    cell : (nx, ny, nz) integer array
        The cell of each voxel centre; −1 outside of the mesh.
    """
    index = grid.to_index(points)
    sign = 1.0 if np.linalg.det(grid.affine[:3, :3]) > 0 else -1.0
    field = np.zeros((*grid.shape, values.shape[1]))
    cell = np.full(grid.shape, -1, dtype=np.int32)
    _fill(index, cells, np.ascontiguousarray(values), sign, field, cell)
    return field, cell


@njit(cache=True)
def _fill(index, cells, values, sign, field, cell):  # type: ignore[no-untyped-def]
    M, w = np.empty((3, 3)), np.empty(4)
    low, high = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for e in range(len(cells)):
        p = index[cells[e, 0]]
        a, b, c = (
            index[cells[e, 1]] - p,
            index[cells[e, 2]] - p,
            index[cells[e, 3]] - p,
        )
        if not invert(a, b, c, M) * sign > 0.0:
            continue
        for d in range(3):
            smallest = min(0.0, a[d], b[d], c[d]) + p[d]
            largest = max(0.0, a[d], b[d], c[d]) + p[d]
            low[d] = max(int(np.ceil(smallest - TOLERANCE)), 0)
            high[d] = min(int(np.floor(largest + TOLERANCE)) + 1, field.shape[d])
        for i in range(low[0], high[0]):
            for j in range(low[1], high[1]):
                for k in range(low[2], high[2]):
                    if weights_of(M, i - p[0], j - p[1], k - p[2], w):
                        cell[i, j, k] = e
                        interpolate(w, cells[e], values, field[i, j, k])


@njit(cache=True, inline="always")
def invert(a, b, c, M):  # type: ignore[no-untyped-def]
    """Fill M with the inverse of the matrix of columns a, b, c; return its det."""
    M[0, 0], M[0, 1] = b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2]
    M[1, 0], M[1, 1] = c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2]
    M[2, 0], M[2, 1] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]
    M[0, 2] = b[0] * c[1] - b[1] * c[0]
    M[1, 2] = c[0] * a[1] - c[1] * a[0]
    M[2, 2] = a[0] * b[1] - a[1] * b[0]
    volume = a[0] * M[0, 0] + a[1] * M[0, 1] + a[2] * M[0, 2]
    if volume != 0.0:
        M /= volume
    return volume


@njit(cache=True, inline="always")
def weights_of(M, x, y, z, w):  # type: ignore[no-untyped-def]
    """Fill the barycentric coordinates w; return whether the cell holds the point."""
    w[1] = M[0, 0] * x + M[0, 1] * y + M[0, 2] * z
    w[2] = M[1, 0] * x + M[1, 1] * y + M[1, 2] * z
    w[3] = M[2, 0] * x + M[2, 1] * y + M[2, 2] * z
    w[0] = 1.0 - w[1] - w[2] - w[3]
    return w.min() >= -TOLERANCE


@njit(cache=True, inline="always")
def interpolate(w, corners, values, result):  # type: ignore[no-untyped-def]
    """Fill the result with the corners' values, weighted by w."""
    for m in range(values.shape[1]):
        total = 0.0
        for n in range(4):
            total += w[n] * values[corners[n], m]
        result[m] = total
