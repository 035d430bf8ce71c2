"""Weights and coefficients against the density they maximise."""

import numpy as np
import pytest
from scipy.optimize import minimize

from physgnn.registration.inference.heavy_tails import (
    NU,
    reweighted,
    robust_start,
    student_weights,
)
from physgnn.registration.inference.rows import MeasuredRows, Modes


def line(rng: np.random.Generator, n: int = 40) -> tuple[MeasuredRows, np.ndarray]:
    """Places of three components that two coefficients explain, noise 0.5 mm."""
    A = rng.normal(size=(3 * n, 2))
    w = np.array([4.0, -2.0])
    noise = np.full(3 * n, 0.5)
    d = A @ w + noise * rng.normal(size=3 * n)
    return MeasuredRows(A / noise[:, None], d / noise, noise, ((n, 3),)), w


def test_a_place_that_fits_weighs_about_one_and_a_far_one_nothing() -> None:
    square = np.concatenate([np.ones(3), [900.0, 0.0, 0.0], [1.0]])
    weights = student_weights(square, ((2, 3), (1, 1)))
    np.testing.assert_allclose(weights, [1.0, (NU + 3) / (NU + 900), 1.0])


def test_the_fit_maximises_the_density_of_students_t() -> None:
    """With many data the variance of the fit is nothing, and it is the mode."""
    rng = np.random.default_rng(1)
    rows, _ = line(rng, 250)
    rows.d[:75] += 30.0
    fit = reweighted(rows, np.full(2, 1e6), np.ones(250), 60)

    def cost(w: np.ndarray) -> float:
        square = ((rows.d - rows.A @ w).reshape(-1, 3) ** 2).sum(axis=1)
        return float(((NU + 3) / 2 * np.log1p(square / NU)).sum())

    mode = minimize(cost, fit.posterior.mean, tol=1e-10).x
    np.testing.assert_allclose(fit.posterior.mean, mode, atol=5e-3)


@pytest.mark.parametrize("seed", range(5))
def test_outliers_are_named_and_cost_little(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, w = line(rng)
    modes = Modes(np.zeros(2, dtype=np.int64), np.empty(0), 0.5)
    bad = rng.choice(40, 8, replace=False)
    clean = robust_start(rows, modes)[1].posterior.mean
    for i in bad:
        rows.d[3 * i : 3 * i + 3] += 15.0 / 0.5 * rng.normal(size=3)
    fit = robust_start(rows, modes)[1]
    far = np.linalg.norm(fit.misfit.reshape(-1, 3), axis=1) > 8
    assert far.sum() >= 7 and fit.outliers[far].all()
    assert not fit.outliers[~far].sum() > 2
    assert np.linalg.norm(fit.posterior.mean - clean) < 0.15
    assert np.linalg.norm(fit.posterior.mean - w) < 0.3


def test_noise_of_each_kind_is_its_own() -> None:
    """Of two kinds that contradict each other the less noisy one is believed."""
    A = np.ones((20, 1))
    noise = np.repeat([0.1, 2.0], 10)
    d = np.repeat([1.0, 2.0], 10)
    rows = MeasuredRows(A / noise[:, None], d / noise, noise, ((10, 1), (10, 1)))
    fit = reweighted(rows, np.array([100.0]), np.ones(20), 20)
    assert fit.posterior.mean[0] == pytest.approx(1.0, abs=0.02)


def test_a_shift_of_a_few_places_is_no_outlier() -> None:
    """Nine places of twenty-five move alike by ten times the noise, the others not."""
    moving = np.zeros((25, 3, 3))
    moving[:9] = np.eye(3)
    noise = np.full(75, 0.5)
    d = moving.reshape(75, 3) @ [1.0, 2.0, -5.0]
    d = d + noise * np.random.default_rng(0).normal(size=75)
    rows = MeasuredRows(moving.reshape(75, 3) / 0.5, d / 0.5, noise, ((25, 3),))
    modes = Modes(np.zeros(3, dtype=np.int64), np.empty(0), 0.5)
    _, fit = robust_start(rows, modes)
    assert not fit.outliers.any()
    np.testing.assert_allclose(fit.posterior.mean, [1.0, 2.0, -5.0], atol=0.6)
