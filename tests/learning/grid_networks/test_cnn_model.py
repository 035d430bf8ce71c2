"""The convolutional network: what it is told, and what changes nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.numpy import load_file

from physgnn.arrays import FloatArray
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.surfaces.distances import signed_distance
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.grid_networks.cnn_model import CNNModel
from physgnn.learning.grid_networks.known_surface import (
    FromKnownDisplacement,
    known_displacement,
    matched_displacement,
    seen_about,
    seen_points,
)
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.observed import ObservedLoadCase
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement

OPTIONS = {"cells": 8, "width": 4, "levels": 2}


def network(body: Body, seed: int = 0) -> CNNModel:
    torch.manual_seed(seed)
    return CNNModel(body, **OPTIONS).eval()


def moved(body: Body, factor: float, shift: float) -> Body:
    mesh = body.mesh
    points = factor * mesh.points + [shift, -2 * shift, 0.5 * shift]
    elsewhere = TetMesh(points, mesh.cells, mesh.region, mesh.point_sets)
    return replace(body, mesh=elsewhere)


def test_where_a_body_is_and_its_size_change_nothing(store: Store) -> None:
    known = known_displacement(store, 0, 3, matched=False)
    here = network(store.body)
    there = network(moved(store.body, 3.0, 100.0))
    larger = PrescribedDisplacement(known.nodes, 3.0 * known.displacement)
    np.testing.assert_allclose(
        there.displacement_from(larger),
        3.0 * here.displacement_from(known),
        atol=1e-4 * np.abs(known.displacement).max(),
    )


def test_an_untrained_network_moves_next_to_nothing(store: Store) -> None:
    known = known_displacement(store, 0, 3, matched=False)
    for seed in range(3):
        model = network(store.body, seed)
        found = np.abs(model.displacement_from(known))
        assert 0 < found.max() < 0.02 * model.grid.spacing


def test_only_points_that_are_seen_count(store: Store) -> None:
    case = store.load_case(0, 3)
    seen = seen_about(store.body, case)
    model, nothing = network(store.body), np.zeros((1, 3))
    some = PrescribedDisplacement(seen[:1], nothing)
    more = PrescribedDisplacement(seen, np.zeros((len(seen), 3)))
    assert (model.displacement_from(some) != model.displacement_from(more)).any()
    assert not np.isin(seen, store.fixed).any()
    assert isinstance(model, FromKnownDisplacement)


def test_a_sample_is_told_with_the_true_displacement_of_what_is_seen(
    store: Store,
) -> None:
    model = network(store.body)
    case = model.sample_case(store, 1, 2)
    assert isinstance(case, ObservedLoadCase)
    known, truth = case.observed, store.displacement(1)[2]
    np.testing.assert_array_equal(known.displacement, truth[known.nodes])
    np.testing.assert_array_equal(model.predict(case), model.displacement_from(known))


def test_a_load_alone_is_answered_from_the_linear_solution(store: Store) -> None:
    # this dataset is linear: both tell the same
    model = network(store.body)
    alone = model.predict(store.load_case(1, 2))
    told = model.predict(model.sample_case(store, 1, 2))
    np.testing.assert_allclose(alone, told, atol=1e-5 * np.abs(told).max())


def test_points_of_the_surface_are_seen_within_a_radius(store: Store) -> None:
    corner = store.mesh.points.max(axis=0)
    seen = seen_points(store.body, corner)
    free = np.setdiff1d(np.unique(boundary_faces(store.mesh)), store.fixed)
    assert set(seen) == set(free)  # the block is smaller than what is seen
    far = moved(store.body, 20.0, 0.0)
    few = seen_points(far, far.mesh.points.max(axis=0))
    away = np.linalg.norm(far.mesh.points[few] - far.mesh.points.max(axis=0), axis=1)
    assert away.max() <= 30.0
    assert 0 < len(few) < len(seen)


def test_matching_finds_a_surface_that_moved_along_its_normal(store: Store) -> None:
    body = moved(store.body, 10.0, 0.0)
    top = body.mesh.point_set("loaded")
    rng = np.random.default_rng(0)
    low, high = body.mesh.points[top].min(axis=0), body.mesh.points[top].max(axis=0)
    measured = rng.uniform(low, high, (20_000, 3)) + np.array([0.0, 0.0, 4.0])
    found = matched_displacement(body, top, measured)
    np.testing.assert_allclose(found.displacement[:, 2], 4.0, atol=1e-9)
    assert np.abs(found.displacement[:, :2]).max() < 4.0


def test_distances_are_negative_inside(block: TetMesh) -> None:
    side = block.points.max()
    targets = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.9], [0.5, 0.5, 1.3]]) * side
    found = signed_distance(block.points, boundary_faces(block), targets)
    np.testing.assert_allclose(found, np.array([-0.5, -0.1, 0.3]) * side, atol=1e-5)


def test_it_learns_and_the_same_seed_gives_the_same_also_when_resumed(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = TrainingConfig(
        "cnn", options=OPTIONS, max_epochs=6, learning_rate=3e-3, batch_size=2
    )
    whole = train(store, split, config, tmp_path / "whole").model
    path, level = split.test[-1].tolist()
    case, truth = whole.sample_case(store, path, level), store.displacement(path)[level]

    def error(of: FloatArray) -> float:
        return float(np.linalg.norm(of - truth, axis=1).mean())

    learnt = error(whole.predict(case))
    assert learnt < error(network(store.body).predict(case))
    assert learnt < error(np.zeros_like(truth))
    train(store, split, replace(config, max_epochs=3), tmp_path / "parts")
    parts = train(store, split, config, tmp_path / "parts", resume=True).model
    for name, weights in whole.arrays().items():
        np.testing.assert_array_equal(weights, parts.arrays()[name])
    weights_file = tmp_path / "whole" / "weights.safetensors"
    assert set(load_file(weights_file)) == set(whole.arrays())


def test_what_it_learnt_serves_another_body(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = TrainingConfig("cnn", options=OPTIONS, max_epochs=1)
    checkpoint = train([store, store], [split, split], config, tmp_path / "run")
    larger = moved(store.body, 3.0, 100.0)
    forces = store.load_case(0, 3).on_points(store.mesh.n_points)[None]
    adapted = adapt(checkpoint, larger, forces).model
    assert isinstance(adapted, CNNModel)
    known = known_displacement(store, 0, 3, matched=False)
    thrice = PrescribedDisplacement(known.nodes, 3.0 * known.displacement)
    found = adapted.displacement_from(thrice)
    assert isinstance(checkpoint.model, CNNModel)
    here = checkpoint.model.displacement_from(known)
    np.testing.assert_allclose(found, 3.0 * here, atol=1e-4 * np.abs(found).max())


@pytest.mark.parametrize(
    "options", [{"cells": 10}, {"width": 0}, {"levels": 0}, {"cells": 4}]
)
def test_a_grid_that_cannot_be_halved_is_refused(
    store: Store, options: dict[str, int]
) -> None:
    with pytest.raises(InputError, match="a multiple of 2 to the levels"):
        CNNModel(store.body, **options)


def test_weights_of_another_shape_are_refused(store: Store) -> None:
    with pytest.raises(InputError, match="width and levels must be"):
        network(store.body).share_weights(CNNModel(store.body, cells=8, width=3))
