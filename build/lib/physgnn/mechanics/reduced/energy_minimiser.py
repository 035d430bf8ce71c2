"""The minimum of an energy of some hundred unknowns, by Newton's method.

Each step goes no further than energy decreases. A step that inverts a cell raises the
energy to infinity: what is found is a stable equilibrium with every det F > 0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from physgnn.arrays import FloatArray

MAX_STEPS = 40
MAX_HALVINGS = 30
LEAST_SHIFT, MAX_SHIFTS = 1e-3, 24  # of `SmallBody.stable`, and four times as much each
ENOUGH = 1e-4  # of the decrease in energy that the slope promises (Armijo's rule)
ROUNDING = 1e-12  # of the energy, must not turn down small steps
TOLERANCE_MM = 1e-4


class SmallBody(Protocol):
    """What minimising needs to know of an energy."""

    @property
    def stable(self) -> FloatArray:
        """A positive definite stiffness, added where that of a state is not."""

    def energy(self, x: FloatArray) -> float:
        """Return the strain energy, N mm; infinite where a cell is inverted."""

    def force(self, x: FloatArray) -> FloatArray:
        """Return its gradient, N."""

    def stiffness(self, x: FloatArray) -> FloatArray:
        """Return its second derivative, N/mm, (n, n) or as `Solve` takes it."""


# From a stiffness and a force to K⁻¹ f; None if K is not positive definite.
Solve = Callable[[FloatArray, FloatArray], FloatArray | None]


def dense_solve(stiffness: FloatArray, force: FloatArray) -> FloatArray | None:
    """Solve with a dense matrix."""
    try:
        factor = cho_factor(stiffness, check_finite=False)
    except LinAlgError:
        return None
    solution: FloatArray = cho_solve(factor, force, check_finite=False)
    return solution


class Descent(StrEnum):
    """How a descent ended."""

    CONVERGED = "the last step was shorter than the tolerance"
    NO_DECREASE = "no step lowered the energy"
    SINGULAR = "the stiffness is singular, and stays so when it is shifted"
    STEPS_SPENT = "the steps were spent"


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where the descent ended.

    Attributes
    ----------
    x : (n,) array
        The unknowns, mm; finite however the descent ended.
    ended : Descent
        Why it went no further.
    steps : int
        Newton steps taken.
    """

    x: FloatArray
    ended: Descent
    steps: int

    @property
    def converged(self) -> bool:
        """Whether the last step was shorter than `TOLERANCE_MM`."""
        return self.ended == Descent.CONVERGED


def minimise(
    body: SmallBody, load: FloatArray, start: FloatArray, *, solve: Solve = dense_solve
) -> Minimum:
    """Descend in energy(x) − load·x.

    Parameters
    ----------
    body : SmallBody
    load : (n,) array
        Dead force on the unknowns, N.
    start : (n,) array
        No cell may be inverted there.
    solve : callable
    """
    x, energy = start, body.energy(start) - float(load @ start)
    for steps in range(1, MAX_STEPS + 1):
        residual = load - body.force(x)
        step = _downwards(body, x, residual, solve)
        if step is None:
            return Minimum(x, Descent.SINGULAR, steps)
        if np.abs(step).max() < TOLERANCE_MM and np.isfinite(body.energy(x + step)):
            # its gain in energy is rounding
            return Minimum(x + step, Descent.CONVERGED, steps)
        scale, slope = 1.0, float(step @ residual)
        for _ in range(MAX_HALVINGS):
            moved = x + scale * step
            lower = body.energy(moved) - float(load @ moved)
            if lower <= energy - ENOUGH * scale * slope + ROUNDING * abs(energy):
                break
            scale /= 2
        else:
            return Minimum(x, Descent.NO_DECREASE, steps)
        x, energy = moved, lower
    return Minimum(x, Descent.STEPS_SPENT, MAX_STEPS)


def _downwards(
    body: SmallBody, x: FloatArray, residual: FloatArray, solve: Solve
) -> FloatArray | None:
    """Return Newton's step, or where K is indefinite one that leads down too.

    K is then shifted by more and more of the stable stiffness. None if even the
    largest shift leaves it singular, as where the body is not held.
    """
    K, weight = body.stiffness(x), 0.0
    for _ in range(MAX_SHIFTS):
        step = solve(K + weight * body.stable, residual)
        if step is not None and np.isfinite(step).all():
            return step
        weight = max(4 * weight, LEAST_SHIFT)
    return None
