"""Explicit dynamics, damped so that it comes to rest as fast as it can.

Central differences of M ü + c M u̇ = r, with r the force out of balance, are

    Δu ← β Δu + α M⁻¹ r.

With A₀ and A_m the least and the greatest eigenvalue of M⁻¹K,

    √β = (√A_m − √A₀) / (√A_m + √A₀),    α = 4 / (√A_m + √A₀)²

damp every mode by √β a step, the best that two numbers can do. Only the end counts, so
masses are scaled. Both eigenvalues follow Rayleigh's quotient of the steps,
q = Δuᵀ(r − r′) / Δuᵀ M Δu: A_m grows as soon as it is exceeded, A₀ is a little below
the least q of the last steps. A low A₀ is safe: all modes then still decay by √β, so
that √β/(1 − √β)·|Δu| bounds the way left to go.

Source: Joldes, Wittek & Miller 2011, "An adaptive dynamic relaxation method for solving
nonlinear finite element problems. Application to brain shift estimation", Int. J.
Numer. Meth. Biomed. Engng 27, 173–185; Underwood 1983, "Dynamic relaxation", in
Belytschko & Hughes (eds.), Computational Methods for Transient Analysis, 245–265.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.equilibrium.norms import largest_norm
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.meshless.options import MeshlessOptions

WINDOW = 50  # steps that one estimate of A₀ is taken over
BELOW = 0.7  # A₀ over the least q: a quotient is never below the least eigenvalue
ABOVE = 1.05  # A_m over a q that exceeds it
FIRST, FLOOR = 1e-4, 1e-7  # A₀ over A_m before anything is known, and at least
MOST_GROWTH = 2.0  # of A₀ from one window to the next


@dataclass(frozen=True, eq=False)
class Imbalance:
    """Forces at one state.

    Attributes
    ----------
    force : (n_points, 3) array
        Out of balance, without what held points answer, N.
    scale : float
        Length of the external force, or of the reaction if that is greater, N.
    inverted : int
        First cell with det F ≤ 0, or −1; the force is then of no use.
    """

    force: FloatArray
    scale: float
    inverted: int


@dataclass(frozen=True, eq=False)
class SettledState:
    """Where the dynamics ended.

    Attributes
    ----------
    state : (n_points, 3) array
        Nodal parameters, mm.
    status : Status
    residual : float
        Force out of balance over its scale.
    inverted : int
        A cell with det F ≤ 0, or −1.
    """

    state: FloatArray
    status: Status
    residual: float
    inverted: int = -1


class DynamicRelaxation:
    """Explicit steps to rest; what is learnt of the eigenvalues is kept for the next.

    Parameters
    ----------
    mass : (n_points,) array
        Scaled masses, N/mm.
    greatest : float
        A_m at the start.
    options : MeshlessOptions

    Attributes
    ----------
    n_steps : int
        Steps taken so far.
    """

    def __init__(
        self, mass: FloatArray, greatest: float, options: MeshlessOptions
    ) -> None:
        self._mass, self._options = mass[:, None], options
        self._greatest, self._least = greatest, FIRST * greatest
        self._window: list[float] = []
        self.n_steps = 0

    def come_to_rest(
        self, balance: Callable[[FloatArray], Imbalance], start: FloatArray
    ) -> SettledState:
        """Step from a state, without velocity, until nothing moves any more."""
        state, step = start, np.zeros_like(start)
        now, residual, scale = balance(start), np.inf, float(np.finfo(float).tiny)
        self._window.clear()
        for n in range(1, self._options.max_iterations + 1):
            if now.inverted >= 0:
                return SettledState(state, Status.INVERTED, np.inf, now.inverted)
            low, high = np.sqrt(self._least), np.sqrt(self._greatest)
            decay = (high - low) / (high + low)
            push = 4 / (high + low) ** 2 * now.force / self._mass
            step = decay**2 * step + push
            state = state + step
            before, now = now, balance(state)
            self.n_steps += 1
            self._learn(step, before.force - now.force)
            # The greatest on the way: where growth is free, all forces go to nothing.
            scale = max(scale, now.scale)
            residual = float(np.linalg.norm(now.force)) / scale
            left = decay / (1 - decay) * largest_norm(step)
            if n >= WINDOW and self._is_enough(now, left, residual):
                return SettledState(state, Status.CONVERGED, residual)
        return SettledState(state, Status.ITERATION_LIMIT, residual)

    def _is_enough(self, now: Imbalance, left: float, residual: float) -> bool:
        options = self._options
        at_rest = left <= options.tolerance_mm and residual <= options.force_tolerance
        return at_rest and now.inverted < 0

    def _learn(self, step: FloatArray, change: FloatArray) -> None:
        """Take the eigenvalues' estimates from a step and the force it changed."""
        moving = float((self._mass * step * step).sum())
        quotient = float((step * change).sum()) / moving if moving > 0 else np.nan
        if not np.isfinite(quotient):
            return
        if quotient > self._greatest:
            self._greatest = ABOVE * quotient
        self._window.append(quotient)
        if len(self._window) == WINDOW:
            found = min(BELOW * min(self._window), MOST_GROWTH * self._least)
            self._least = max(found, FLOOR * self._greatest)
            self._window.clear()
