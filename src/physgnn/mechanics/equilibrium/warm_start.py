"""Warm start: from a guess to the equilibrium under a load, else along its path.

Where a body has several equilibria under a load, the one meant is that which the load
reaches as it grows from nothing. A guess says which that is, so equilibrium is looked
for down in energy from it. If the guess belongs to a fraction of the load, the path is
followed from there to the whole load. Without a guess, or if there is no equilibrium
next to it, the path is followed from rest.
"""

from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.continuation import PathFollower
from physgnn.mechanics.equilibrium.energy_descent import descend
from physgnn.mechanics.equilibrium.norms import largest_norm
from physgnn.mechanics.equilibrium.quasi_newton import Equilibrium, QuasiNewton
from physgnn.mechanics.equilibrium.reference_states import (
    NearestReference,
    ReferenceState,
)
from physgnn.mechanics.equilibrium.relaxation import (
    ReferenceFactor,
    Relaxation,
    any_state_force,
    relax,
)
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import SolverOptions
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadCase, LoadPath

MAX_ITERATIONS = 20  # a step from a guess; what needs more is better halved
STEPS = 30  # from rest; longer ones may miss where a path turns back
MIN_STEP = 1 / 120  # from a guess; where these fail it's better to begin at rest
# The last try, from rest, is the solver's: what that reaches is reached here too.
FROM_REST = SolverOptions()
MAX_HALVINGS = 10
FAR = 1 / 10  # of the largest displacement, is too far for a guess to choose a state


@dataclass(frozen=True, eq=False)
class WarmStartSolution:
    """Where a warm start ended.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm; if the load was not reached, the last equilibrium on the path towards it.
    status : Status
        CONVERGED: the estimated error of the worst point is below the tolerance.
    origin : str
        What it was reached by: "guess" or "path".
    counts : dict of str to int
        Factorisations, back-solves and residuals spent.
    """

    displacement: FloatArray
    status: Status
    origin: str
    counts: dict[str, int]


class WarmStartSolver:
    """Finds equilibria on one body, near guesses where there are any.

    Parameters
    ----------
    body : Body
        What is loaded.
    nearest : callable, optional
        From a load's forces (n_points, 3), N, to the nearest reference state; by
        default that is the rest state.
    threads : int
        Threads of the linear solver.
    """

    def __init__(
        self,
        body: Body,
        *,
        nearest: NearestReference | None = None,
        threads: int = 1,
    ) -> None:
        self._body, self._pattern, self._threads = body, body.pattern, threads
        self._linear = make_linear_solver(
            body.pattern, precision="single", threads=threads
        )
        at_rest = ReferenceState.of(body, np.zeros_like(body.mesh.points))
        self._nearest: NearestReference = nearest or (lambda _: at_rest)

    def relax(self, case: LoadCase, guess: FloatArray) -> Relaxation:
        """Take a few cheap steps from a guess towards the equilibrium under a load.

        Parameters
        ----------
        case : LoadCase
        guess : (n_points, 3) array
            mm, finite; cells may be inverted in it.
        """
        reference = self._nearest(case.on_points(len(guess)))
        iteration = replace(
            self._iteration(case, np.inf),
            solver=ReferenceFactor(self._pattern, reference),
        )
        start = self._pattern.unknowns(guess)
        if self._body.elements.averaging is None:
            iteration = replace(iteration, force=any_state_force)
        else:  # stress is extrapolated in single cells only
            end = self._pattern.unknowns(reference.displacement)
            start = _without_inverted_cells(iteration, end, start)
        return relax(iteration, start)

    def solve(
        self,
        case: LoadCase,
        guess: FloatArray | None = None,
        *,
        load_fraction: float = 1.0,
        tolerance_mm: float,
    ) -> WarmStartSolution:
        """Return the equilibrium under a load case.

        Parameters
        ----------
        case : LoadCase
        guess : (n_points, 3) array, optional
            mm; cells may be inverted in it. Without it the load is followed from rest.
        load_fraction : float
            The fraction of the load that the guess belongs to, in (0, 1]; of no
            account without a guess.
        tolerance_mm : float
            Bound on the estimated error of the worst point.

        Raises
        ------
        InputError
            If a loaded node is missing from the mesh or fixed.
        """
        iteration = self._iteration(case, tolerance_mm)
        origin, found = "guess", None
        if guess is not None and np.isfinite(guess).all():
            found = self._next_to(iteration, case, guess, load_fraction)
            if found is not None and load_fraction < 1.0:
                origin = "path"
                found = _follow(iteration, found.state, load_fraction, MIN_STEP)
        if found is None or found.status != Status.CONVERGED:
            origin, found = "path", _follow_from_rest(iteration)
        return WarmStartSolution(
            iteration.displacement(found.state, 1.0),
            found.status,
            origin,
            iteration.counts,
        )

    def _next_to(
        self,
        iteration: QuasiNewton,
        case: LoadCase,
        guess: FloatArray,
        load_fraction: float,
    ) -> Equilibrium | None:
        """Return the equilibrium under a fraction of the load next to a guess.

        The last on the way to the whole load is proven to be stable, which takes a
        factor of the tangent there. So the way to it begins with that of the nearest
        reference state.
        """
        near = self._nearest(load_fraction * case.on_points(len(guess)))
        safe = self._pattern.unknowns(near.displacement)
        start = self._pattern.unknowns(guess)
        start = _without_inverted_cells(iteration, safe, start)
        whole = load_fraction == 1.0
        found = descend(
            iteration,
            start,
            fallback=safe,
            load_factor=load_fraction,
            proven=whole,
            factorised=whole
            and iteration.begin_with(
                ReferenceFactor(self._pattern, near), near.displacement, start
            ),
        )
        far = largest_norm(found.state - start) > FAR * largest_norm(found.state)
        return None if far or found.status != Status.CONVERGED else found

    def _iteration(self, case: LoadCase, tolerance_mm: float) -> QuasiNewton:
        path = LoadPath(case.nodes, case.forces, np.ones(1))
        return QuasiNewton(
            self._body,
            self._pattern,
            self._linear,
            Loading(self._body.mesh, path, self._body.fixed),
            tolerance_mm,
            MAX_ITERATIONS,
            threads=self._threads,
        )


def _without_inverted_cells(
    iteration: QuasiNewton, reference: FloatArray, guess: FloatArray
) -> FloatArray:
    """Draw a guess back towards a reference state until no cell is inverted."""
    part = 1.0
    for _ in range(MAX_HALVINGS):
        start = reference + part * (guess - reference)
        if iteration.residual(start, 1.0)[1] < 0:
            return start
        part /= 2
    return reference


def _follow_from_rest(iteration: QuasiNewton) -> Equilibrium:
    within = min(iteration.tolerance_mm, FROM_REST.tolerance_mm)
    most = FROM_REST.max_iterations
    iteration = replace(iteration, tolerance_mm=within, max_iterations=most)
    rest = np.zeros(iteration.pattern.n_unknowns)
    if not iteration.refactorize(rest, 0.0):
        return Equilibrium(rest, Status.LIMIT_POINT, np.inf)
    return _follow(iteration, rest, 0.0, FROM_REST.min_step)


def _follow(
    iteration: QuasiNewton, state: FloatArray, load_fraction: float, min_step: float
) -> Equilibrium:
    """Let the load grow from a fraction; return the last equilibrium if it gets stuck.

    The iteration's factor must be that of a state near the one it starts from.
    """
    slope = iteration.direction(iteration.residual(state, 1.0)[0]) / (
        1.0 - load_fraction
    )
    walk = PathFollower(
        iteration,
        lambda factor: state + (factor - load_fraction) * slope,
        min_step=min_step,
        start=load_fraction,
    )
    n_steps = int(np.ceil(STEPS * (1.0 - load_fraction)))
    for target in np.linspace(load_fraction, 1.0, n_steps + 1)[1:].tolist():
        found, _ = walk.advance_or_snap_through(target)
        if found.status != Status.CONVERGED:
            return Equilibrium(walk.state, found.status, found.residual_norm)
    rest = np.zeros_like(state)
    return descend(iteration, walk.state, fallback=rest)  # is it stable?
