"""Points that hang together by edges."""

import itertools

import numpy as np

from physgnn.geometry.mesh_topology import points_within
from physgnn.geometry.tetmesh import TetMesh


def test_points_within_counts_edges(block: TetMesh) -> None:
    start = np.array([0])
    reached = [points_within(block, start, n) for n in range(4)]
    assert reached[0].sum() == 1
    cells = block.cells[(block.cells == 0).any(axis=1)]
    assert set(np.flatnonzero(reached[1])) == set(np.unique(cells))
    assert all((a <= b).all() for a, b in itertools.pairwise(reached))
