"""Resection: a region taken out of the mesh."""

import numpy as np

from physgnn.arrays import IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh


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
    kept = mesh.region != label
    if kept.all() or not kept.any():
        labels = np.unique(mesh.region).tolist()
        raise InputError(
            f"region {label} cannot be removed: the mesh has regions {labels}"
        )
    points = np.unique(mesh.cells[kept])
    index = np.full(mesh.n_points, -1, dtype=np.int64)
    index[points] = np.arange(len(points))
    sets = {name: index[ids] for name, ids in mesh.point_sets.items()}
    remaining = TetMesh(
        points=mesh.points[points],
        cells=index[mesh.cells[kept]],
        region=mesh.region[kept],
        point_sets={name: ids[ids >= 0] for name, ids in sets.items()},
    )
    return remaining, index
