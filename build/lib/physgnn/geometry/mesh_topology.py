"""How the points of a mesh hang together by the edges of its cells."""

import numpy as np

from physgnn.arrays import BoolArray, IntArray
from physgnn.geometry.tetmesh import TetMesh


def points_within(mesh: TetMesh, start: IntArray, n_steps: int) -> BoolArray:
    """Return which points are at most so many edges away from some, (n_points,)."""
    near = np.zeros(mesh.n_points, dtype=np.bool_)
    near[start] = True
    for _ in range(n_steps):
        near[mesh.cells[near[mesh.cells].any(axis=1)]] = True
    return near
