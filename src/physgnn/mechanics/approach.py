"""From a guess to the equilibrium under one load, or along the load's path from rest.

Where a body has several equilibria under a load, the one meant is that which the load
reaches as it grows from nothing. A guess says which that is, so equilibrium is looked
for down in energy from it; without one, or if there is none next to it, the load is
followed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.assembly import make_pattern
from physgnn.mechanics.descent import descend
from physgnn.mechanics.element import make_elements
from physgnn.mechanics.known_states import KnownState, NearestKnown
from physgnn.mechanics.linear_solver import make_linear_solver
from physgnn.mechanics.loading import Loading
from physgnn.mechanics.loads import LoadCase, LoadPath
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.path_following import PathFollower
from physgnn.mechanics.quasi_newton import Equilibrium, QuasiNewton, largest_norm
from physgnn.mechanics.relaxation import (
    KnownFactor,
    Relaxation,
    any_state_force,
    relax,
)
from physgnn.mechanics.rest_state import fixed_points
from physgnn.mechanics.solution import Status
from physgnn.mechanics.solver import advance_or_fall

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_ITERATIONS = 20  # a step of the walk from rest; what needs more is better halved
STEPS, MIN_STEP = 30, 1e-3  # from rest; longer ones may miss where a path turns back
MAX_HALVINGS = 10
FAR = 1 / 10  # of the largest displacement, is too far for a guess to choose a state


@dataclass(frozen=True, eq=False)
class Approached:
    """Where an approach ended.

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


class Approach:
    """Finds equilibria on one body, near guesses where there are any.

    Parameters
    ----------
    mesh : TetMesh
    materials : mapping of region label to Material
    fixed : str or integer array
    known : callable, optional
        From a load's forces (n_points, 3), N, to the nearest equilibrium known; by
        default that is the rest state.
    element : str
        As in `SolverOptions`.
    threads : int
        Threads of the linear solver.
    """

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | IntArray = "fixed",
        *,
        known: NearestKnown | None = None,
        element: str = "tet4",
        threads: int = 1,
    ) -> None:
        self._mesh, self._fixed = mesh, fixed_points(mesh, fixed)
        self._elements = make_elements(mesh, materials, element)
        self._pattern = make_pattern(
            mesh.cells, mesh.n_points, self._fixed, self._elements.averaging
        )
        self._linear = make_linear_solver(
            self._pattern, precision="single", threads=threads
        )
        rest = np.zeros((mesh.n_points, 3))
        at_rest = KnownState.of(self._elements, self._pattern, rest)
        self._known: NearestKnown = known or (lambda _: at_rest)

    def relax(self, case: LoadCase, guess: FloatArray) -> Relaxation:
        """Take a few cheap steps from a guess towards the equilibrium under a load.

        Parameters
        ----------
        case : LoadCase
        guess : (n_points, 3) array
            mm, finite; cells may be inverted in it.
        """
        known = self._known(case.on_points(len(guess)))
        iteration = replace(
            self._iteration(case, np.inf), solver=KnownFactor(self._pattern, known)
        )
        start = self._unknowns(guess)
        if self._elements.averaging is None:
            iteration = replace(iteration, force=any_state_force)
        else:  # stress is continued in lone cells only
            end = self._unknowns(known.displacement)
            start = _without_inverted_cells(iteration, end, start)
        return relax(iteration, start)

    def solve(
        self, case: LoadCase, guess: FloatArray | None = None, *, tolerance_mm: float
    ) -> Approached:
        """Return the equilibrium under a load case.

        Parameters
        ----------
        case : LoadCase
        guess : (n_points, 3) array, optional
            mm; cells may be inverted in it. Without it the load is followed from rest.
        tolerance_mm : float
            Bound on the estimated error of the worst point.

        Raises
        ------
        InputError
            If a loaded node is missing from the mesh or fixed.
        """
        iteration = self._iteration(case, tolerance_mm)
        known = self._known(case.on_points(self._mesh.n_points)).displacement
        origin, found = "guess", None
        if guess is not None and np.isfinite(guess).all():
            safe, start = self._unknowns(known), self._unknowns(guess)
            start = _without_inverted_cells(iteration, safe, start)
            found = descend(iteration, start, fallback=safe)
            if largest_norm(found.state - start) > FAR * largest_norm(found.state):
                found = None
        if found is None or found.status != Status.CONVERGED:
            origin, found = "path", _follow(iteration)
        return Approached(
            iteration.displacement(found.state, 1.0),
            found.status,
            origin,
            iteration.counts,
        )

    def _iteration(self, case: LoadCase, tolerance_mm: float) -> QuasiNewton:
        path = LoadPath(case.nodes, case.forces, np.ones(1))
        return QuasiNewton(
            self._elements,
            self._pattern,
            self._linear,
            Loading(self._mesh, path, self._fixed),
            tolerance_mm,
            MAX_ITERATIONS,
        )

    def _unknowns(self, displacement: FloatArray) -> FloatArray:
        return displacement[self._pattern.free].ravel()


def _without_inverted_cells(
    iteration: QuasiNewton, known: FloatArray, guess: FloatArray
) -> FloatArray:
    """Draw a guess back towards a known state until no cell is inverted."""
    share = 1.0
    for _ in range(MAX_HALVINGS):
        start = known + share * (guess - known)
        if iteration.residual(start, 1.0)[1] < 0:
            return start
        share /= 2
    return known


def _follow(iteration: QuasiNewton) -> Equilibrium:
    """Let the load grow from nothing; return the last equilibrium if it gets stuck."""
    rest = np.zeros(iteration.pattern.n_unknowns)
    if not iteration.refactorize(rest, 0.0):
        return Equilibrium(rest, Status.LIMIT_POINT, np.inf)
    linear = iteration.direction(iteration.residual(rest, 1.0)[0])
    walk = PathFollower(iteration, lambda s: s * linear, min_step=MIN_STEP)
    for target in np.arange(1, STEPS + 1) / STEPS:
        found, _ = advance_or_fall(walk, float(target))
        if found.status != Status.CONVERGED:
            return Equilibrium(walk.state, found.status, found.residual_norm)
    return descend(iteration, walk.state, fallback=rest)  # is it stable?
