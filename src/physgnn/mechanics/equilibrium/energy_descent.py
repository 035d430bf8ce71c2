"""Down in energy to the equilibrium next to a rough guess.

Quasi-Newton directions with a factor that is always positive definite lead down in
potential energy; each is followed no further than to where the energy's slope along it
has turned (a secant on the slope, which costs the residual that is needed anyway). What
is found this way is a minimum, a stable equilibrium, however poor the guess.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.equilibrium.norms import dot, largest_norm, norm
from physgnn.mechanics.equilibrium.quasi_newton import Equilibrium, QuasiNewton
from physgnn.mechanics.equilibrium.solution import Status

MAX_STEPS = 40
RENEW_AFTER = 10  # steps with one factor (a factor costs ~20 of them)
MAX_TRIALS = 10  # along one direction
OVERSHOT = -0.5  # slope that is too far past the minimum, in slopes at the start


def descend(
    iteration: QuasiNewton,
    start: FloatArray,
    *,
    fallback: FloatArray,
    load_factor: float = 1.0,
    max_steps: int = MAX_STEPS,
    proven: bool = True,
    factorised: bool = False,
) -> Equilibrium:
    """Descend from a start to equilibrium under a load.

    Parameters
    ----------
    iteration : QuasiNewton
        Knows the loads and the tolerance.
    start : (n_unknowns,) array
        No cell may be inverted there.
    fallback : (n_unknowns,) array
        A state whose factor serves where that of the current state is not positive
        definite: a stable equilibrium.
    load_factor : float
    max_steps : int
    proven : bool
        Whether K(u) must be seen to be positive definite at the end. Energy has no
        other minima, but rounding and a tolerance can hide a saddle.
    factorised : bool
        Whether the iteration has a positive definite factor to begin with.

    Returns
    -------
    Equilibrium
        CONVERGED once the estimated error is below the iteration's tolerance and, if it
        must be, the equilibrium was seen to be stable.
    """
    descent = _Descent(iteration, start, fallback, load_factor, proven)
    status = None if factorised else descent.renew()
    for _ in range(max_steps):
        if status is not None:
            return Equilibrium(descent.state, status, norm(descent.r))
        status = descent.step()
    # CONVERGED is 0, so `or` would take it for none.
    status = Status.ITERATION_LIMIT if status is None else status
    return Equilibrium(descent.state, status, norm(descent.r))


class _Descent:
    """A state on its way down, and what was seen of the factor in use."""

    def __init__(
        self,
        iteration: QuasiNewton,
        start: FloatArray,
        fallback: FloatArray,
        load_factor: float,
        must_be_proven: bool,
    ) -> None:
        self.state, (self.r, _) = start, iteration.residual(start, load_factor)
        self._must_be_proven = must_be_proven
        self._iteration, self._fallback = iteration, fallback
        self._load_factor = load_factor
        self._size, self._since_factor, self._proven = np.inf, 0, False

    def renew(self, *, prove: bool = False) -> Status | None:
        """Factorise K(u), or unless it must prove u stable, that of the fallback."""
        self._size, self._since_factor = np.inf, 0
        renewed, factor = self._iteration.refactorize, self._load_factor
        self._proven = renewed(self.state, factor)
        if self._proven or (not prove and renewed(self._fallback, factor)):
            return None
        return Status.LIMIT_POINT

    def step(self) -> Status | None:
        """Go down one step; return how the descent ended, None if it did not."""
        iteration, previous = self._iteration, self._size
        d = iteration.direction(self.r)
        scale, r_new = follow(
            iteration, self.state, d, self.r, load_factor=self._load_factor
        )
        if scale == 0.0:
            return self.renew() if self._since_factor else Status.INVERTED
        iteration.remember(scale * d, self.r - r_new)
        self.state, self.r = self.state + scale * d, r_new
        self._size = scale * largest_norm(d)
        newton = self._proven and self._since_factor == 0
        # The factor proves K(u) positive definite as long as u is where it was made.
        self._proven = self._proven and self._size < iteration.tolerance_mm
        self._since_factor += 1
        whole = scale == 1.0
        left = iteration.error_left(self._size, previous, fresh=newton)
        if whole and left < iteration.tolerance_mm:
            enough = self._proven or not self._must_be_proven
            return Status.CONVERGED if enough else self.renew(prove=True)
        slow = whole and self._since_factor >= 3 and self._size > previous
        return self.renew() if slow or self._since_factor >= RENEW_AFTER else None


def follow(
    iteration: QuasiNewton,
    state: FloatArray,
    d: FloatArray,
    r: FloatArray,
    *,
    load_factor: float = 1.0,
) -> tuple[float, FloatArray]:
    """Return how far to go along a direction, 0 if nowhere, and the residual there."""
    scale, slope = 1.0, dot(d, r)  # of the energy, downwards
    for _ in range(MAX_TRIALS):
        r_new, inverted = iteration.residual(state + scale * d, load_factor)
        if inverted >= 0:
            scale /= 2
            continue
        slope_new = dot(d, r_new)
        if slope_new > OVERSHOT * slope:
            return scale, r_new
        scale *= max(slope / (slope - slope_new), 0.1)
    return 0.0, r
