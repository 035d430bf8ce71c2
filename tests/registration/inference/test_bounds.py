"""Errors are of every posterior that the data leave, by its probability."""

import numpy as np
import pytest

from physgnn.registration.inference.bounds import (
    N_DRAWS,
    Alternative,
    Factors,
    error_lengths,
    estimate_of,
    mixed_covariance,
)

RESPONSE = np.eye(3, dtype=np.float32).reshape(3, 1, 3)  # a point, a mode an axis


def alternatives(probability: float, away: float) -> list[Alternative]:
    """One posterior about the registered place, one about another."""
    small = 0.01 * np.eye(3)
    there = np.array([away, 0.0, 0.0])
    return [
        Alternative(1.0 - probability, np.zeros(3), small),
        Alternative(probability, there, small),
    ]


def bound(probability: float, away: float) -> float:
    lengths = error_lengths(alternatives(probability, away), RESPONSE, 0)
    return estimate_of(lengths, 0.9, Factors(1.0, 1.0)).max_mm


def test_an_offset_that_may_be_widens_the_bound() -> None:
    none, hardly, perhaps = (bound(p, 5.0) for p in (0.0, 0.02, 0.5))
    assert hardly == pytest.approx(none, rel=0.1)
    assert perhaps > 5.0 > 5 * none
    # and the wider, the likelier it is
    several = [bound(p, 5.0) for p in (0.05, 0.11, 0.2, 0.5)]
    assert several == sorted(several)


def test_deviation_and_covariance_are_the_second_moment_of_the_mixture() -> None:
    mixed = alternatives(0.25, 4.0)
    wanted = 0.01 * np.eye(3)
    wanted[0, 0] += 0.25 * 4.0**2
    np.testing.assert_allclose(mixed_covariance(mixed), wanted)
    lengths = error_lengths(mixed, RESPONSE, 0)
    assert len(lengths.weights) == 2 * N_DRAWS
    assert lengths.weights.sum() == pytest.approx(1.0)
    assert lengths.deviation_mm[0] == pytest.approx(np.sqrt(np.trace(wanted)), rel=0.03)


def test_a_bound_does_not_jump_with_the_probability() -> None:
    for p in (1e-3, 0.1, 0.5):
        assert bound(p + 1e-9, 3.0) == pytest.approx(bound(p - 1e-9, 3.0), rel=1e-3)
