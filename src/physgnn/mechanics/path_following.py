"""Walking along a path of equilibria, in steps as long as converge."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from physgnn.mechanics.descent import descend
from physgnn.mechanics.extrapolation import PathHistory
from physgnn.mechanics.quasi_newton import Equilibrium, QuasiNewton
from physgnn.mechanics.solution import Status

FloatArray = NDArray[np.float64]

LONGEST_FALL = 150  # steps; the snap-throughs of the published sets took up to 70


class PathFollower:
    """One walk along one path, from an equilibrium on it.

    Parameters
    ----------
    iteration : QuasiNewton
        Knows the loads; its factor must be that of a state near the start.
    trend : callable
        From a load factor to the state expected there, (n_unknowns,); at the start it
        must be the equilibrium. What the walk finds is extrapolated as a departure
        from it.
    min_step : float
        Smallest step in the load factor before the walk is given up.
    start : float
        The load factor it starts at.
    """

    def __init__(
        self,
        iteration: QuasiNewton,
        trend: Callable[[float], FloatArray],
        *,
        min_step: float,
        start: float = 0.0,
    ) -> None:
        self._iteration, self._trend, self._min_step = iteration, trend, min_step
        self._departures = PathHistory(start, np.zeros(iteration.pattern.n_unknowns))
        self._trusted = float("inf")  # longest step to begin with, once one failed

    @property
    def reached(self) -> float:
        """The load factor of the last equilibrium found."""
        return self._departures.newest[0]

    @property
    def state(self) -> FloatArray:
        """The last equilibrium found, (n_unknowns,)."""
        load_factor, departure = self._departures.newest
        return self._trend(load_factor) + departure

    def advance(
        self,
        target: float,
        *,
        step: float | None = None,
        loose_mm: float | None = None,
    ) -> Equilibrium:
        """Go to a load factor, in smaller steps where one is too long.

        Parameters
        ----------
        target : float
        step : float, optional
            The first step to try; if not given all the way, or what the last target
            needed.
        loose_mm : float, optional
            Tolerance of equilibria on the way, if other than at the target.
        """
        step = step or min(target - self.reached, self._trusted)
        while True:
            reached = self.reached
            goal = target if reached + 1.5 * step > target else reached + step
            found = self._iteration.solve(
                self._guess(goal),
                goal,
                tolerance_mm=None if goal == target else loose_mm,
            )
            if found.status == Status.CONVERGED:
                self._departures.add(goal, found.state - self._trend(goal))
                step = 2 * (goal - reached)
                self._trusted = max(self._trusted, step)
                if goal == target:
                    return found
                continue
            step = self._trusted = (goal - reached) / 2
            if step < self._min_step:
                return found
            # The failed try may have left the factor at a useless state.
            if not self._iteration.refactorize(self.state, reached):
                return Equilibrium(found.state, Status.LIMIT_POINT, np.inf)

    def fall(self, target: float) -> Equilibrium:
        """Go to a load factor by a way that no equilibria lead along.

        Where a path turns back, a body of some damping falls down in energy to another
        equilibrium, if there is one; from there the walk goes on.
        """
        found = descend(
            self._iteration,
            self.state,
            fallback=self.state,
            load_factor=target,
            max_steps=LONGEST_FALL,
        )
        if found.status == Status.CONVERGED:
            departure = found.state - self._trend(target)
            self._departures = PathHistory(target, departure)
            self._trusted = float("inf")
        return found

    def _guess(self, load_factor: float) -> FloatArray:
        return self._trend(load_factor) + self._departures.predict(load_factor)
