"""Descent in an energy ends where it should, and says why where it cannot."""

from dataclasses import dataclass

import numpy as np

from physgnn.mechanics.reduced.energy_minimiser import Descent, minimise


@dataclass(frozen=True)
class Quadratic:
    """The energy xᵀKx/2."""

    K: np.ndarray
    stable: np.ndarray

    def energy(self, x: np.ndarray) -> float:
        return float(x @ self.K @ x / 2)

    def force(self, x: np.ndarray) -> np.ndarray:
        return self.K @ x

    def stiffness(self, x: np.ndarray) -> np.ndarray:
        del x
        return self.K


LOAD = np.array([1.0, -2.0, 3.0])


def test_a_quadratic_is_solved_in_one_step_and_one_to_confirm_it() -> None:
    K = np.diag([1.0, 2.0, 5.0])
    found = minimise(Quadratic(K, K), LOAD, np.zeros(3))
    np.testing.assert_allclose(found.x, LOAD / [1, 2, 5])
    assert (found.ended, found.converged, found.steps) == (Descent.CONVERGED, True, 2)


def test_a_stiffness_that_stays_singular_is_named_and_leaves_finite_unknowns() -> None:
    for free in (np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]), np.full((3, 3), np.nan)):
        found = minimise(Quadratic(free, free), LOAD, np.zeros(3))
        assert (found.ended, found.converged) == (Descent.SINGULAR, False)
        assert np.isfinite(found.x).all()


def test_an_energy_without_a_minimum_spends_its_steps() -> None:
    """Down a saddle there is no end: the shifted steps go on, and that is said."""
    found = minimise(
        Quadratic(np.diag([1.0, 1.0, -1e-9]), np.eye(3)), LOAD, np.zeros(3)
    )
    assert not found.converged
    assert found.ended in (Descent.STEPS_SPENT, Descent.NO_DECREASE)
    assert np.isfinite(found.x).all()
