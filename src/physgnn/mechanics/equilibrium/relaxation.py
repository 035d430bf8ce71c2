"""A few cheap steps from a guess towards equilibrium: they show how far off it is.

Directions come from the factor of a reference state, sharpened by what the steps learn;
nothing is factorised. In inverted cells the stress is extrapolated
(`physgnn.mechanics.elements.inverted`), so any guess will do, and the steps turn most
of these cells back.
"""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.inverted import extrapolated_force
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.mechanics.equilibrium.energy_descent import follow
from physgnn.mechanics.equilibrium.norms import largest_norm
from physgnn.mechanics.equilibrium.quasi_newton import QuasiNewton
from physgnn.mechanics.equilibrium.reference_states import ReferenceState

MAX_STEPS = 8
ENOUGH = 0.05  # a step so small beside the whole way ends it
LEFT = 1.5  # error that remains, in last steps; chosen on validation paths


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Where the steps from a guess led.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm.
    moved : (n_points, 3) array
        The way from the guess, mm.
    last : (n_points, 3) array
        The last step of it, mm; where not even a first could be taken, that which was
        looked for.
    """

    displacement: FloatArray
    moved: FloatArray
    last: FloatArray

    @property
    def error(self) -> FloatArray:
        """Estimate of the guess's error, (n_points, 3), mm.

        It points the way the guess was moved, and is longer than that by what seems to
        remain.
        """
        if not self.moved.any():
            return LEFT * self.last
        length = np.linalg.norm(self.moved, axis=1, keepdims=True)
        remains = LEFT * np.linalg.norm(self.last, axis=1, keepdims=True)
        tiny = np.finfo(float).tiny
        error: FloatArray = self.moved * (1.0 + remains / np.maximum(length, tiny))
        return error


@dataclass(frozen=True, eq=False)
class ReferenceFactor:
    """The response about a reference state, as the linear solver of an iteration."""

    pattern: Pattern
    reference: ReferenceState

    def factorize(self, data: FloatArray) -> bool:  # noqa: ARG002
        """Return False: this factor is never renewed."""
        return False

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b over the free unknowns."""
        force = self.pattern.on_points(right)
        return self.pattern.unknowns(self.reference.respond(force))


def any_state_force(elements: Elements, u: FloatArray) -> tuple[FloatArray, int]:
    """Return `extrapolated_force`, for an iteration to which no state is too bad."""
    force, _ = extrapolated_force(elements, u)
    return force, -1


def relax(iteration: QuasiNewton, start: FloatArray) -> Relaxation:
    """Take a few steps down in energy at load factor 1.

    Parameters
    ----------
    iteration : QuasiNewton
        Knows the load; has a `ReferenceFactor` for a solver.
    start : (n_unknowns,) array
        The guess.
    """
    state, last = start, np.zeros_like(start)
    r, _ = iteration.residual(start, 1.0)
    for _ in range(MAX_STEPS):
        d = iteration.direction(r)
        scale, r_new = follow(iteration, state, d, r)
        if scale == 0.0:
            last = last if last.any() else d
            break
        last = scale * d
        iteration.remember(last, r - r_new)
        state, r = state + last, r_new
        if largest_norm(last) < ENOUGH * largest_norm(state - start):
            break

    def on_points(unknowns: FloatArray) -> FloatArray:
        return iteration.displacement(unknowns, 1.0)

    return Relaxation(on_points(state), on_points(state - start), on_points(last))
