"""Falx and tentorium: the sheets between parts of a brain that a label map tells apart.

The falx lies between the left and the right cortex, the tentorium between the cortex of
both and the cerebellum. Neither has a label of its own, so a sheet is where two parts
are equally near, both within half the width of a fissure.
"""

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.segmentation.labels.label_table import LabelTable
from physgnn.geometry.surface import Surface, edge_lengths
from physgnn.geometry.tetmesh import TetMesh

# Of the widest fissure between two parts, mm.
HALF_WIDTH_MM = 5.0
# A point of the mesh belongs to a sheet within this part of its edges: one layer.
LAYER = 0.6
# Fewer points are no sheet but a place where two labels meet by chance.
FEWEST_POINTS = 10
NAMES = ("falx", "tentorium")


def membrane_sets(
    mesh: TetMesh, labels: LabelVolume, table: LabelTable
) -> dict[str, IntArray]:
    """Return the points of a mesh along the falx and the tentorium.

    Parameters
    ----------
    mesh : TetMesh
        Made from the label map.
    labels : LabelVolume
        The label map.
    table : LabelTable
        What its labels mean; one without left and right, or without cerebellum, has no
        falx, or no tentorium.

    Returns
    -------
    dict of str to integer arrays
        Ascending; without the sheets that the map does not show.
    """
    edge = float(np.median(edge_lengths(Surface(mesh.points, _faces(mesh)))))
    found = {}
    for name, (one, other) in _sides(table).items():
        sheet = sheet_points(labels, one, other)
        if len(sheet):
            distance, _ = KDTree(sheet).query(mesh.points)
            points = np.flatnonzero(distance <= LAYER * edge).astype(np.int64)
            if len(points) >= FEWEST_POINTS:
                found[name] = points
    return found


def sheet_points(
    labels: LabelVolume, one: tuple[int, ...], other: tuple[int, ...]
) -> FloatArray:
    """Return where two parts of a label map are equally near, (n, 3), mm.

    Parameters
    ----------
    labels : LabelVolume
        The label map.
    one, other : tuple of int
        Labels of the two parts.

    Returns
    -------
    (n, 3) array
        Middles of the voxel faces across which the nearer part changes, both within 5
        mm; none if a part is not there.
    """
    parts = labels.mask(one), labels.mask(other)
    if not (parts[0].any() and parts[1].any()):
        return np.empty((0, 3))
    window, grid = _window(parts[0] | parts[1], labels.grid)
    spacing = grid.voxel_mm
    first, second = (
        ndimage.distance_transform_edt(~part[window], sampling=spacing)
        for part in parts
    )
    near = np.maximum(first, second) <= HALF_WIDTH_MM
    nearer = first <= second
    middles = []
    for axis in range(3):
        low = [slice(None)] * 3
        high = [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        a, b = tuple(low), tuple(high)
        index = np.argwhere((nearer[a] != nearer[b]) & near[a] & near[b]).astype(float)
        index[:, axis] += 0.5
        middles.append(index)
    return grid.to_world(np.concatenate(middles))


def _sides(
    table: LabelTable,
) -> dict[str, tuple[tuple[int, ...], tuple[int, ...]]]:
    falx, tentorium = NAMES
    sides = {}
    if table.left and table.right:
        sides[falx] = (table.left, table.right)
        if table.cerebellum:
            sides[tentorium] = ((*table.left, *table.right), table.cerebellum)
    return sides


def _window(mask: np.ndarray, grid: ImageGrid) -> tuple[tuple[slice, ...], ImageGrid]:
    """Return the box of a mask, and its grid."""
    used = [np.flatnonzero(mask.any(axis=(*{0, 1, 2} - {i},))) for i in range(3)]
    window = tuple(slice(int(u[0]), int(u[-1]) + 2) for u in used)
    affine = grid.affine.copy()
    affine[:3, 3] = grid.to_world(np.array([w.start for w in window]))
    shape = mask[window].shape
    return window, ImageGrid((shape[0], shape[1], shape[2]), affine)


def _faces(mesh: TetMesh) -> np.ndarray:
    return mesh.cells[:, :3]
