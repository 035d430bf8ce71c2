"""Resection: a region taken out of the mesh."""

import numpy as np

from physgnn.arrays import IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh, without_unused_points


def remove_region(mesh: TetMesh, label: int) -> tuple[TetMesh, IntArray]:
    """Return the mesh without a region's cells and the points only they had.

    Parameters
    ----------
    mesh : TetMesh
    label : int
        The region to take out.

    Returns
    -------
    mesh : TetMesh
        What is left; point sets keep their names and lose the points removed.
    index : (n_points before,) array
        New index of every old point, −1 where it was removed.

    Raises
    ------
    InputError
        If there is no such region, or nothing else.
    """
    remaining_cells = mesh.region != label
    if remaining_cells.all() or not remaining_cells.any():
        labels = np.unique(mesh.region).tolist()
        raise InputError(
            f"region {label} cannot be removed: the mesh has regions {labels}"
        )
    remaining, used = without_unused_points(
        mesh.points,
        mesh.cells[remaining_cells],
        mesh.region[remaining_cells],
        mesh.point_sets,
    )
    index = np.full(mesh.n_points, -1, dtype=np.int64)
    index[used] = np.arange(len(used))
    return remaining, index
