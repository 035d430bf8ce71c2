"""Down in energy to the equilibrium next to a rough guess.

Quasi-Newton directions with a factor that is always positive definite lead down in
potential energy; each is followed no further than to where the energy's slope along it
has turned (a secant on the slope, which costs the residual that is needed anyway). What
is found this way is a minimum, a stable equilibrium, however poor the guess.
"""

import numpy as np
from numpy.typing import NDArray

from physgnn.mechanics.quasi_newton import (
    Equilibrium,
    QuasiNewton,
    dot,
    largest_norm,
    norm,
)
from physgnn.mechanics.solution import Status

FloatArray = NDArray[np.float64]

MAX_STEPS = 40
RENEW_AFTER = 10  # steps with one factor (a factor costs ~20 of them)
MAX_TRIALS = 10  # along one direction
OVERSHOT = -0.5  # slope that is too far past the minimum, in slopes at the start


def descend(
    iteration: QuasiNewton, start: FloatArray, *, fallback: FloatArray
) -> Equilibrium:
    """Descend from a start to equilibrium at load factor 1.

    Parameters
    ----------
    iteration : QuasiNewton
        Knows the loads and the tolerance.
    start : (n_unknowns,) array
        No cell may be inverted there.
    fallback : (n_unknowns,) array
        A state whose factor serves where that of the current state is not positive
        definite: a stable equilibrium.

    Returns
    -------
    Equilibrium
        CONVERGED once the estimated error is below the iteration's tolerance.
    """
    if not _refactorize(iteration, start, fallback):
        return Equilibrium(start, Status.LIMIT_POINT, np.inf)
    state, (r, _) = start, iteration.residual(start, 1.0)
    previous, since_factor = np.inf, 0
    for _ in range(MAX_STEPS):
        d = iteration.direction(r)
        scale, r_new = _follow(iteration, state, d, r)
        if scale == 0.0:
            if since_factor == 0 or not _refactorize(iteration, state, fallback):
                return Equilibrium(state, Status.INVERTED, norm(r))
            previous, since_factor = np.inf, 0
            continue
        iteration.remember(scale * d, r - r_new)
        state, r, size = state + scale * d, r_new, scale * largest_norm(d)
        whole = scale == 1.0
        if whole and iteration.error_left(size, previous) < iteration.tolerance_mm:
            return Equilibrium(state, Status.CONVERGED, norm(r))
        since_factor += 1
        slow = whole and since_factor >= 3 and size > previous
        if since_factor >= RENEW_AFTER or slow:
            if not _refactorize(iteration, state, fallback):
                return Equilibrium(state, Status.LIMIT_POINT, norm(r))
            size, since_factor = np.inf, 0
        previous = size
    return Equilibrium(state, Status.ITERATION_LIMIT, norm(r))


def _refactorize(
    iteration: QuasiNewton, state: FloatArray, fallback: FloatArray
) -> bool:
    return iteration.refactorize(state, 1.0) or iteration.refactorize(fallback, 1.0)


def _follow(
    iteration: QuasiNewton, state: FloatArray, d: FloatArray, r: FloatArray
) -> tuple[float, FloatArray]:
    """Return how far to go along a direction, 0 if nowhere, and the residual there."""
    scale, slope = 1.0, dot(d, r)  # of the energy, downwards
    for _ in range(MAX_TRIALS):
        r_new, inverted = iteration.residual(state + scale * d, 1.0)
        if inverted >= 0:
            scale /= 2
            continue
        slope_new = dot(d, r_new)
        if slope_new > OVERSHOT * slope:
            return scale, r_new
        scale *= max(slope / (slope - slope_new), 0.1)
    return 0.0, r
