"""Distances between loads, and the loads farthest from one another."""

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, NeoHookean, RestState
from physgnn.mechanics.reduced.expansions.load_distance import LoadDistance, farthest

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def test_distances_are_those_of_energy(block: TetMesh) -> None:
    nodes = block.point_set("loaded")[:3]
    forces = np.random.default_rng(0).normal(size=(2, 3, 3)) * 1e-2
    fields = np.zeros((2, block.n_points, 3))
    fields[:, nodes] = forces
    apart = fields[0] - fields[1]
    work = (apart * RestState(Body(block, MATERIALS)).solve(apart)).sum()
    x = LoadDistance(Body(block, MATERIALS), nodes).coordinates(forces)
    assert np.linalg.norm(x[0] - x[1]) == pytest.approx(np.sqrt(work), rel=1e-6)


def test_the_farthest_come_first_and_none_twice() -> None:
    points = np.array([[1.0, 0], [3, 0], [3, 0], [0, 2], [2.9, 0]])
    assert farthest(points, 3).tolist() == [1, 3, 0]
    assert len(farthest(points, 10)) == 4
