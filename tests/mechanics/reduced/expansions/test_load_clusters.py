"""Clusters of loads: distances of energy, means that leave little of third order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, NeoHookean, RestState
from physgnn.mechanics.reduced.expansions.load_clusters import (
    clusters,
    energy_coordinates,
    third_order,
)
from physgnn.mechanics.reduced.expansions.load_distance import farthest

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def test_distances_are_those_of_energy(block: TetMesh) -> None:
    forces = np.random.default_rng(0).normal(size=(60, *block.points.shape)) * 1e-3
    rest = RestState(Body(block, MATERIALS, block.point_set("fixed")))
    forces[:, block.point_set("fixed")] = 0.0
    x = energy_coordinates(rest, forces)
    apart = forces[3] - forces[50]
    work = float((apart * rest.solve(apart)).sum())
    assert np.linalg.norm(x[3] - x[50]) == pytest.approx(np.sqrt(work), rel=1e-6)
    mean = forces.mean(axis=0)
    work = float((mean * rest.solve(mean)).sum())
    assert np.linalg.norm(x.mean(axis=0)) == pytest.approx(np.sqrt(work), rel=1e-5)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**31), n_places=st.integers(1, 4))
def test_loads_in_some_places_are_found_there(seed: int, n_places: int) -> None:
    rng = np.random.default_rng(seed)
    places = 10.0 * np.eye(4)[:n_places]
    loads = np.repeat(places, 20, axis=0) + rng.normal(size=(20 * n_places, 4)) * 0.1
    loads = loads[rng.permutation(len(loads))]
    weights = clusters(loads, n_places)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    apart = np.linalg.norm((weights @ loads)[:, None] - places, axis=2)
    np.testing.assert_array_less(apart.min(axis=0), 0.2)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**31), n_clusters=st.integers(1, 5))
def test_means_leave_less_than_the_loads_they_begin_with(
    seed: int, n_clusters: int
) -> None:
    loads = np.random.default_rng(seed).normal(size=(50, 3))
    weights = clusters(loads, n_clusters)
    assert (weights >= 0).all()
    begun = third_order(loads, loads[farthest(loads, n_clusters)])
    assert third_order(loads, weights @ loads) <= begun * (1 + 1e-9)


def test_a_mean_of_cubes_stands_still() -> None:
    """The gradient of Σ d³, Σ 3 d (c − x), vanishes at the mean of the one cluster."""
    loads = 20.0 + np.random.default_rng(0).normal(size=(40, 2))
    (centre,) = clusters(loads, 1) @ loads
    distance = np.linalg.norm(loads - centre, axis=1)
    gradient = (distance[:, None] * (centre - loads)).sum(axis=0)
    np.testing.assert_allclose(gradient, 0.0, atol=1e-3)


def test_fewer_loads_than_clusters_are_their_own() -> None:
    loads = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 2.0]])
    assert sorted(map(tuple, clusters(loads, 5) @ loads)) == [(0, 2), (1, 0)]


def test_no_centre_leaves_the_loads_themselves() -> None:
    loads = np.array([[3.0, 4.0], [0.0, 1.0]])
    assert third_order(loads, np.zeros((0, 2))) == pytest.approx(126.0)
