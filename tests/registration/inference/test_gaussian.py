import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.registration.inference.gaussian import choose_variances, condition

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_posterior_is_that_of_the_normal_equations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    A, d = rng.normal(size=(9, 5)), rng.normal(size=9)
    prior, noise = rng.uniform(0.1, 2.0, 5), 0.3
    found = condition(A, d.reshape(3, 3), prior, noise)
    precision = A.T @ A / noise**2 + np.diag(1 / prior)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(precision), atol=1e-8)
    np.testing.assert_allclose(
        found.mean, np.linalg.solve(precision, A.T @ d / noise**2), atol=1e-8
    )


@given(SEEDS)
def test_held_out_points_are_predicted_from_the_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    A, d = rng.normal(size=(9, 5)), rng.normal(size=9)
    prior, noise = np.ones(5), 0.5
    found = condition(A, d.reshape(3, 3), prior, noise)
    for block in range(3):
        out = slice(3 * block, 3 * block + 3)
        kept = np.delete(np.arange(9), np.arange(9)[out])
        others = condition(A[kept], d[kept].reshape(2, 3), prior, noise)
        missed = d[out] - A[out] @ others.mean
        np.testing.assert_allclose(found.held_out[block], missed)


def test_variances_are_recovered_and_surprise_is_one() -> None:
    rng = np.random.default_rng(0)
    family = np.repeat([0, 1], 150)
    A = rng.normal(size=(300, 300)) / 10
    deviations = np.array([3.0, 0.5])[family]
    surprises = []
    d = A @ (deviations * rng.normal(size=300)) + 0.2 * rng.normal(size=300)
    prior = choose_variances(A, d, family, 0.2)
    assert np.sqrt(prior[0]) == pytest.approx(3.0, rel=0.2)
    assert np.sqrt(prior[-1]) == pytest.approx(0.5, rel=0.8)
    for _ in range(20):
        d = A @ (deviations * rng.normal(size=300)) + 0.2 * rng.normal(size=300)
        surprises.append(condition(A, d[:, None], deviations**2, 0.2).surprise)
    assert np.mean(surprises) == pytest.approx(1.0, abs=0.05)
    too_sure = condition(A, d[:, None], deviations**2 / 25, 0.04).surprise
    assert too_sure > 3.0
