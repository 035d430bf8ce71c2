"""Learners keep float32 and the meaning of their targets' unit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.ensemble import ExtraTreesRegressor

from physgnn.learning.classical.estimator import Estimator
from physgnn.learning.classical.random_trees import RandomTrees, _at_most
from physgnn.learning.classical.scaled_network import ScaledNetwork


def rows(seed: int, n: int = 400) -> tuple[np.ndarray, np.ndarray]:
    inputs = np.random.default_rng(seed).normal(size=(n, 4)).astype(np.float32)
    inputs[:, 3] = 7.0  # a column that says nothing
    targets = np.stack([inputs[:, 0] * 3, 0.1 * inputs[:, 1] - 1], axis=1)
    return inputs, targets


def learners(seed: int) -> list[Estimator]:
    return [
        ScaledNetwork((16,), epochs=400, seed=seed),
        RandomTrees(10, smallest_leaf=2, seed=seed),
    ]


@pytest.mark.parametrize("kind", [0, 1])
def test_learns_and_repeats_with_its_seed(kind: int) -> None:
    inputs, targets = rows(0)
    first, again, other = (learners(seed)[kind] for seed in (1, 1, 2))
    for learner in (first, again, other):
        learner.fit(inputs, targets)
    new, true = rows(1)
    found = first.predict(new)
    assert np.abs(found - true).mean() < 0.5 * np.abs(targets).mean()
    np.testing.assert_array_equal(found, again.predict(new))
    assert (found != other.predict(new)).any()


def test_network_is_indifferent_to_the_units() -> None:
    """Targets in another unit, inputs in others: the same answer in that unit."""
    inputs, targets = rows(0)
    plain, scaled = (ScaledNetwork((16,), epochs=20, seed=0) for _ in range(2))
    plain.fit(inputs, targets)
    scaled.fit(64 * inputs + 8, 1024 * targets)
    np.testing.assert_allclose(
        scaled.predict(64 * inputs + 8) / 1024, plain.predict(inputs), atol=0.02
    )


def test_network_computes_in_float32() -> None:
    inputs, targets = rows(0)
    learner = ScaledNetwork((16,), epochs=2, seed=0).fit(inputs, targets)
    assert learner.predict(inputs).dtype == np.float32
    assert learner.arrays()["weights.0"].dtype == np.float32


@pytest.mark.parametrize("kind", [0, 1])
def test_what_is_written_down_predicts_the_same_bit_for_bit(kind: int) -> None:
    learner, again = (learners(seed)[kind] for seed in (1, 9))
    learner.fit(*rows(0))
    again.restore(learner.arrays())
    new, _ = rows(1)
    np.testing.assert_array_equal(again.predict(new), learner.predict(new))


def test_predictions_are_those_of_scikit_learn() -> None:
    """Of its own estimators; leaves are kept in float32."""
    inputs, targets = rows(0)
    new, _ = rows(1)
    trees = ExtraTreesRegressor(
        10, min_samples_leaf=2, max_features=1 / 3, random_state=1
    )
    ours = RandomTrees(10, smallest_leaf=2, seed=1).fit(inputs, targets)
    expected = trees.fit(inputs, targets).predict(new)
    np.testing.assert_allclose(ours.predict(new), expected, atol=1e-6)


@given(st.floats(-1e3, 1e3))
def test_rows_fall_the_same_way_by_thresholds_in_float32(threshold: float) -> None:
    near = np.float32(threshold)
    rows = [np.nextafter(near, np.float32(side)) for side in (-np.inf, np.inf)]
    ours = _at_most(np.array([threshold]))[0]
    for row in [near, *rows]:
        assert (row <= ours) == (np.float64(row) <= threshold)
