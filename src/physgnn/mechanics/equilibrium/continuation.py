"""Continuation along a path of equilibria, in the longest steps that converge."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.equilibrium.energy_descent import descend
from physgnn.mechanics.equilibrium.norms import largest_norm
from physgnn.mechanics.equilibrium.predictor_step import PathHistory
from physgnn.mechanics.equilibrium.quasi_newton import Equilibrium, QuasiNewton
from physgnn.mechanics.equilibrium.solution import Status

# Descent steps of a snap-through; those of the published sets took up to 70.
MAX_SNAP_STEPS = 150
# In largest displacements so far: what moves farther was not snapped through, but had
# cells blown out.
FARTHEST_SNAP = 1.0
# Of the largest displacement: farther from where the path points another equilibrium
# was found. Steps of a thirtieth went up to 0.07 on dataset 1, a jump went 0.14.
FARTHEST_MISS = 0.1
# A whole factor takes as long as 40 back-solves of 90,000 unknowns, and 100 of 300,000;
# of the published sets, 28,000, a part made 14 paths no faster.
PART_FROM_UNKNOWNS = 50_000


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
        """Go to a load factor, in smaller steps where one is too long or leads astray.

        Parameters
        ----------
        target : float
        step : float, optional
            The first step to try; if not given all the way, or what the last target
            needed.
        loose_mm : float, optional
            Tolerance of equilibria on the way, if other than at the target.
        """
        if step is None:
            step = min(target - self.reached, self._trusted)
        while True:
            reached = self.reached
            goal = target if reached + 1.5 * step > target else reached + step
            found = self._step(goal, None if goal == target else loose_mm)
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
            if not self._renew():
                return Equilibrium(found.state, Status.LIMIT_POINT, np.inf)

    def advance_or_snap_through(self, target: float) -> tuple[Equilibrium, str]:
        """Go to a load factor along the path, or by a snap-through to another.

        Where a path turns back, a damped body loses energy until it comes to rest in
        another equilibrium, if there is one. The walk goes on from there.

        Returns
        -------
        Equilibrium, str
            What was found, and a line about it if the path did not lead there.
        """
        stuck = self.advance(target)
        if stuck.status == Status.CONVERGED:
            return stuck, ""
        reached, before = self.reached, self.state
        found = self._snap_through(target)
        if found is not None:
            way = largest_norm(found.state - before)
            return (
                found,
                f"snapped through at load factor {reached:.4f} by {way:.2g} mm",
            )
        return stuck, stuck.status.stopped_at(reached, stuck.inverted)

    def _snap_through(self, target: float) -> Equilibrium | None:
        found = descend(
            self._iteration,
            self.state,
            fallback=self.state,
            load_factor=target,
            max_steps=MAX_SNAP_STEPS,
        )
        way = largest_norm(found.state - self.state)
        far = way >= FARTHEST_SNAP * largest_norm(self.state)
        if far or found.status != Status.CONVERGED:
            return None
        self._departures = PathHistory(target, found.state - self._trend(target))
        self._trusted = float("inf")
        return found

    def _renew(self) -> bool:
        """Renew the factor: the try that failed may have left it at a useless state.

        Of a large body the part that has deformed most will do, which with a shorter
        step takes far less time than the whole.
        """
        iteration, (reached, _) = self._iteration, self._departures.newest
        large = iteration.pattern.n_unknowns >= PART_FROM_UNKNOWNS
        if large and iteration.renew_part(self.state, reached):
            return True
        return iteration.refactorize(self.state, reached)

    def _step(self, load_factor: float, tolerance_mm: float | None) -> Equilibrium:
        """Look for the equilibrium where the path points, not for any other."""
        guess = self._trend(load_factor) + self._departures.predict(load_factor)
        found = self._iteration.solve(guess, load_factor, tolerance_mm=tolerance_mm)
        missed = largest_norm(found.state - guess)
        if missed <= FARTHEST_MISS * largest_norm(found.state):
            return found
        astray = found.status == Status.CONVERGED
        return replace(found, status=Status.LIMIT_POINT) if astray else found
