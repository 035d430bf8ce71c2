"""Learners keep float32 and the meaning of their targets' unit."""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.ensemble import ExtraTreesRegressor, RandomForestRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel
from sklearn.svm import SVR
from sklearn.tree import DecisionTreeRegressor

from physgnn.learning.classical.estimators.estimator import Estimator
from physgnn.learning.classical.estimators.kernel_rows import (
    KernelRows,
    gaussian_process,
    support_vectors,
)
from physgnn.learning.classical.estimators.linear_rows import LinearRows
from physgnn.learning.classical.estimators.radial_rows import RadialRows
from physgnn.learning.classical.estimators.random_trees import (
    FOREST,
    SINGLE,
    RandomTrees,
    _at_most,
)
from physgnn.learning.classical.estimators.scaled_network import ScaledNetwork
from physgnn.learning.classical.estimators.scaling import Scaling


def rows(seed: int, n: int = 400) -> tuple[np.ndarray, np.ndarray]:
    inputs = np.random.default_rng(seed).normal(size=(n, 4)).astype(np.float32)
    inputs[:, 3] = 7.0  # a column that says nothing
    targets = np.stack([inputs[:, 0] * 3, 0.1 * inputs[:, 1] - 1], axis=1)
    return inputs, targets


SVR_ROWS = partial(support_vectors, cost=10.0, tube=0.02)
LEARNERS: dict[str, Callable[[int], Estimator]] = {
    "network": lambda seed: ScaledNetwork((16,), epochs=400, seed=seed),
    "extra trees": lambda seed: RandomTrees(10, smallest_leaf=2, seed=seed),
    "forest": lambda seed: RandomTrees(10, smallest_leaf=2, seed=seed, grown=FOREST),
    "tree": lambda seed: RandomTrees(1, smallest_leaf=2, seed=seed, grown=SINGLE),
    "linear": lambda _: LinearRows(1e-9),
    "svr": lambda seed: KernelRows(SVR_ROWS, most_rows=300, seed=seed),
    "gpr": lambda seed: KernelRows(gaussian_process, most_rows=300, seed=seed),
    "rbf": lambda _: RadialRows("linear", smoothing=0.0, most_rows=300),
}
SEEDLESS = ("linear", "rbf")


@pytest.mark.parametrize("kind", LEARNERS)
def test_learns_and_repeats_with_its_seed(kind: str) -> None:
    inputs, targets = rows(0)
    first, again, other = (LEARNERS[kind](seed) for seed in (1, 1, 2))
    for learner in (first, again, other):
        learner.fit(inputs, targets)
    new, true = rows(1)
    found = first.predict(new)
    assert np.abs(found - true).mean() < 0.5 * np.abs(targets).mean()
    np.testing.assert_array_equal(found, again.predict(new))
    assert (found != other.predict(new)).any() == (kind not in SEEDLESS)


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


@pytest.mark.parametrize("kind", LEARNERS)
def test_what_is_written_down_predicts_the_same_bit_for_bit(kind: str) -> None:
    learner, again = (LEARNERS[kind](seed) for seed in (1, 9))
    learner.fit(*rows(0))
    again.restore(learner.arrays())
    new, _ = rows(1)
    np.testing.assert_array_equal(again.predict(new), learner.predict(new))


@pytest.mark.parametrize(
    ("kind", "theirs"),
    [
        (
            "extra trees",
            ExtraTreesRegressor(
                10, min_samples_leaf=2, max_features=1 / 3, random_state=1
            ),
        ),
        (
            "forest",
            RandomForestRegressor(
                10, min_samples_leaf=2, max_features=1 / 3, random_state=1
            ),
        ),
    ],
)
def test_trees_predict_as_those_of_scikit_learn(kind: str, theirs: Any) -> None:
    """Of its own estimators; leaves are kept in float32."""
    inputs, targets = rows(0)
    new, _ = rows(1)
    ours = LEARNERS[kind](1)
    ours.fit(inputs, targets)
    expected = theirs.fit(inputs, targets).predict(new)
    np.testing.assert_allclose(ours.predict(new), expected, atol=1e-6)


def test_a_single_tree_is_a_tree_of_all_rows_and_inputs() -> None:
    """As good as scikit-learn's own where they part: ties between equal splits."""
    inputs, targets = rows(0)
    ours = RandomTrees(1, smallest_leaf=2, seed=1, grown=SINGLE).fit(inputs, targets)
    theirs = DecisionTreeRegressor(min_samples_leaf=2).fit(inputs, targets)
    own, their = (each.predict(inputs) - targets for each in (ours, theirs))
    assert np.square(own).mean() == pytest.approx(np.square(their).mean(), rel=0.05)


def test_support_vectors_predict_as_those_of_scikit_learn() -> None:
    inputs, targets = rows(0, 200)
    new, _ = rows(1)
    ours = KernelRows(SVR_ROWS, most_rows=200, seed=0).fit(inputs, targets)
    scaling = Scaling.of(inputs, targets)
    theirs = SVR(C=10.0, epsilon=0.02, gamma=1 / 4)
    for target in (0, 1):
        theirs.fit(scaling.inputs(inputs), scaling.targets(targets)[:, target])
        expected = theirs.predict(scaling.inputs(new)) * scaling.unit
        found = ours.predict(new)[:, target] - scaling.mean[target]
        np.testing.assert_allclose(found, expected, atol=1e-4)


def test_a_gaussian_process_predicts_as_that_of_scikit_learn() -> None:
    """With the length and the noise found, on rows all of which are used."""
    inputs, targets = rows(0, 200)
    new, _ = rows(1)
    ours = KernelRows(gaussian_process, most_rows=200, seed=0).fit(inputs, targets)
    scaling = Scaling.of(inputs, targets)
    order = np.random.default_rng(0)
    order.permutation(200)
    few = order.permutation(200)
    theirs = GaussianProcessRegressor(
        RBF(2.0, (1e-1, 1e3)) + WhiteKernel(1e-2, (1e-6, 1e1))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        theirs.fit(scaling.inputs(inputs)[few], scaling.targets(targets)[few])
    expected = scaling.back(theirs.predict(scaling.inputs(new)))
    np.testing.assert_allclose(ours.predict(new), expected, atol=1e-4)


def test_radial_functions_go_through_the_rows_they_have_seen() -> None:
    inputs, targets = rows(0, 100)
    ours = RadialRows("linear", smoothing=0.0, most_rows=100)
    found = ours.fit(inputs, targets).predict(inputs)
    np.testing.assert_allclose(found, targets, atol=1e-4)


def test_a_linear_learner_finds_a_linear_map() -> None:
    inputs, targets = rows(0)
    new, true = rows(1)
    found = LinearRows(1e-9).fit(inputs, targets).predict(new)
    np.testing.assert_allclose(found, true, atol=1e-4)


@given(st.floats(-1e3, 1e3))
def test_rows_fall_the_same_way_by_thresholds_in_float32(threshold: float) -> None:
    near = np.float32(threshold)
    rows = [np.nextafter(near, np.float32(side)) for side in (-np.inf, np.inf)]
    ours = _at_most(np.array([threshold]))[0]
    for row in [near, *rows]:
        assert (row <= ours) == (np.float64(row) <= threshold)
