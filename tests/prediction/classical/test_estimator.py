"""Learners keep float32 and the meaning of their targets' unit."""

import numpy as np
import pytest

from physgnn.prediction.classical.estimator import (
    Estimator,
    ScaledNetwork,
    random_trees,
)


def rows(seed: int, n: int = 400) -> tuple[np.ndarray, np.ndarray]:
    inputs = np.random.default_rng(seed).normal(size=(n, 4)).astype(np.float32)
    inputs[:, 3] = 7.0  # a column that says nothing
    targets = np.stack([inputs[:, 0] * 3, 0.1 * inputs[:, 1] - 1], axis=1)
    return inputs, targets


def learners(seed: int) -> list[Estimator]:
    return [
        ScaledNetwork((16,), epochs=400, seed=seed),
        random_trees(10, smallest_leaf=2, seed=seed),
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
    assert learner._network.coefs_[0].dtype == np.float32
