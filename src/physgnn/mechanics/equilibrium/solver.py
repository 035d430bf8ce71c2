"""Equilibrium along a load path: levels asked for, steps between them as needed."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.equilibrium.continuation import PathFollower
from physgnn.mechanics.equilibrium.quasi_newton import QuasiNewton
from physgnn.mechanics.equilibrium.solution import LevelRecord, Solution, Status
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.protocols import LinearSolver
from physgnn.mechanics.linear.side_by_side import Company, PathFactor, SharedFactor
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials.table import Material


@dataclass(frozen=True)
class SolverOptions:
    """How tightly and how patiently to solve.

    Attributes
    ----------
    tolerance_mm : float
        Bound on the estimated displacement error of the worst point at every level.
    max_iterations : int
        Iterations a step before it is halved.
    min_step : float
        Smallest step in the load factor before the path is given up.
    threads : int
        Threads of the linear solver.
    """

    tolerance_mm: float = 1e-4
    max_iterations: int = 40
    min_step: float = 1e-3
    threads: int = 1

    def __post_init__(self) -> None:
        if not self.tolerance_mm > 0 or not 0 < self.min_step < 1:
            raise InputError(
                "tolerance_mm must be > 0 and min_step in (0, 1) "
                f"(got {self.tolerance_mm}, {self.min_step})"
            )
        for name in ("max_iterations", "threads"):
            if not getattr(self, name) >= 1:
                raise InputError(f"{name} must be ≥ 1 (got {getattr(self, name)})")


DEFAULT_OPTIONS = SolverOptions()
SMALL_FACTOR = 2.0**-20  # a power of two: dividing by it loses nothing


@dataclass(frozen=True, eq=False)
class _Unknowns:
    """What is solved for when these points are held, and with what."""

    held: IntArray
    pattern: Pattern
    linear: LinearSolver
    shared: SharedFactor | None


class Solver:
    """A body ready to be loaded: everything that does not depend on the load.

    Parameters
    ----------
    body : Body
        What is loaded.
    options : SolverOptions
        How tightly and how patiently to solve.
    side_by_side : bool
        Whether `solve` is called from several threads: paths then take turns, and
        share the factor of the state at rest.
    """

    def __init__(
        self,
        body: Body,
        *,
        options: SolverOptions = DEFAULT_OPTIONS,
        side_by_side: bool = False,
    ) -> None:
        self._body, self._options = body, options
        self._side_by_side, self._company = side_by_side, Company()
        self._unknowns: _Unknowns | None = None

    def stop(self) -> None:
        """Let paths that other threads solve, side by side, end with an exception."""
        self._company.stop()

    def solve(self, path: LoadPath) -> Solution:
        """Find equilibrium at every level of a path.

        Returns
        -------
        Solution
            A level that could not be reached has a status that says why.

        Raises
        ------
        InputError
            If a loaded node is missing from the mesh or fixed, or fixed points and
            prescribed displacements together leave a part of the body free to move.
        """
        loading = Loading(self._body.mesh, path, self._body.fixed)
        with self._company.walk():
            iteration = self._iteration(loading)
            solution = _follow(iteration, path, self._options.min_step)
        if not isinstance(iteration.solver, PathFactor):
            return solution
        return replace(solution, seconds=solution.seconds - iteration.solver.waited)

    def _iteration(self, loading: Loading) -> QuasiNewton:
        unknowns = self._unknowns
        if unknowns is None or not np.array_equal(unknowns.held, loading.held):
            unknowns = self._unknowns = self._find_unknowns(loading.held)
        return QuasiNewton(
            self._body,
            unknowns.pattern,
            self._linear(unknowns),
            loading,
            self._options.tolerance_mm,
            self._options.max_iterations,
            threads=self._options.threads,
        )

    def _linear(self, unknowns: _Unknowns) -> LinearSolver:
        if unknowns.shared is None:
            return unknowns.linear
        return PathFactor(self._company, unknowns.shared, unknowns.linear)

    def _find_unknowns(self, held: IntArray) -> _Unknowns:
        pattern = self._body.pattern_under(held)

        def linear() -> LinearSolver:
            threads = self._options.threads
            return make_linear_solver(pattern, precision="single", threads=threads)

        shared = SharedFactor(linear()) if self._side_by_side else None
        return _Unknowns(held, pattern, linear(), shared)


def _follow(iteration: QuasiNewton, path: LoadPath, min_step: float) -> Solution:
    """Walk from rest along all levels of a path."""
    record, remarks = LevelRecord(path, iteration.elements.n_points), []
    slope = _slope_at_rest(iteration)
    walk = PathFollower(iteration, lambda factor: factor * slope, min_step=min_step)
    for level, target in enumerate(path.load_factors.tolist()):
        found, remark = walk.advance_or_snap_through(target)
        if remark:
            remarks.append(remark)
        if found.status != Status.CONVERGED:
            record.stop(level, found.status)
            break
        norm = iteration.load_norm(found.state, target)
        relative = found.residual_norm / max(norm, np.finfo(float).tiny)
        record.keep(level, iteration.displacement(found.state, target), relative)
    return record.solution(
        reached=walk.reached,
        message="; ".join(remarks),
        counts=dict(iteration.counts),
    )


def _slope_at_rest(iteration: QuasiNewton) -> FloatArray:
    """Return du/dλ at rest, the linear solution, whatever the loads."""
    rest = np.zeros(iteration.pattern.n_unknowns)
    if not iteration.refactorize(rest, 0.0):
        raise InputError(
            "the fixed points don't hold the body: its stiffness matrix is "
            "singular; fix at least three points that are not in line"
        )
    return iteration.direction(iteration.residual(rest, SMALL_FACTOR)[0] / SMALL_FACTOR)


def solve(
    mesh: TetMesh,
    path: LoadPath,
    *,
    materials: Mapping[int, Material],
    fixed: str | IntArray = "fixed",
    element: str = DEFAULT_ELEMENT,
    options: SolverOptions = DEFAULT_OPTIONS,
) -> Solution:
    """Find equilibrium along a load path.

    Parameters
    ----------
    mesh : TetMesh
    path : LoadPath
    materials : mapping of region label to Material
    fixed : str or integer array
        Name of a point set, or point indices.
    element : str
        The finite element, one of those that `Body` takes.
    options : SolverOptions

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        If the load, the materials or the fixed points don't fit the mesh, or the
        element is unknown.
    """
    body = Body(mesh, materials, fixed, element=element)
    return Solver(body, options=options).solve(path)
