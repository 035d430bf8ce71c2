"""Fields of a tetrahedral mesh at points anywhere.

Points are sorted into bins; each cell then looks at those in the bins that its bounding
box meets, as a cell does with voxels (`physgnn.imaging.voxel_fields`).
"""

import numpy as np
from numba import njit

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.voxel_fields import interpolate, invert, weights_of

BIN_MM, MOST_BINS = 4.0, 128  # about the size of a cell; along an axis


def interpolated(
    mesh: TetMesh, values: FloatArray, points: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Interpolate linearly within the cells that hold points.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    values : (n_points, k) array
        On the mesh's points.
    points : (n, 3) array
        mm.

    Returns
    -------
    found : (n, k) array
        The values; 0 outside of the mesh.
    inside : (n,) boolean array
        Whether a cell holds the point.
    """
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    size = np.maximum(BIN_MM, (high - low) / MOST_BINS)
    shape = ((high - low) // size).astype(np.int64) + 1
    # those outside of the box go into its outer bins, where no cell will hold them
    places = np.clip(((points - low) / size).astype(np.int64), 0, shape - 1)
    bins = np.ravel_multi_index(tuple(places.T), tuple(shape))
    order = np.argsort(bins, kind="stable")
    starts = np.searchsorted(bins[order], np.arange(shape.prod() + 1))
    found = np.zeros((len(points), values.shape[1]))
    inside = np.zeros(len(points), dtype=np.bool_)
    field = np.ascontiguousarray(values, dtype=np.float64)
    _fill(mesh.points, mesh.cells, field, points, order, starts, low, size, shape,
          found, inside)  # fmt: skip
    return found, inside


@njit(cache=True)
def _fill(nodes, cells, values, points, order, starts, low, size, shape, found, inside):  # type: ignore[no-untyped-def]
    M, w = np.empty((3, 3)), np.empty(4)
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for e in range(len(cells)):
        p = nodes[cells[e, 0]]
        a, b, c = (
            nodes[cells[e, 1]] - p,
            nodes[cells[e, 2]] - p,
            nodes[cells[e, 3]] - p,
        )
        if not invert(a, b, c, M) > 0.0:
            continue
        for d in range(3):
            least = min(0.0, a[d], b[d], c[d]) + p[d] - low[d]
            most = max(0.0, a[d], b[d], c[d]) + p[d] - low[d]
            first[d] = min(max(int(least / size[d] - 1e-6), 0), shape[d] - 1)
            last[d] = min(int(most / size[d] + 1e-6), shape[d] - 1)
        for i in range(first[0], last[0] + 1):
            for j in range(first[1], last[1] + 1):
                row = (i * shape[1] + j) * shape[2]
                for n in range(starts[row + first[2]], starts[row + last[2] + 1]):
                    x = points[order[n]]
                    if weights_of(M, x[0] - p[0], x[1] - p[1], x[2] - p[2], w):
                        inside[order[n]] = True
                        interpolate(w, cells[e], values, found[order[n]])
