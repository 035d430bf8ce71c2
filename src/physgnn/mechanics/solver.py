"""Equilibrium along a load path: levels asked for, steps between them as needed."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.assembly import make_pattern
from physgnn.mechanics.element import make_elements
from physgnn.mechanics.extrapolation import PathHistory
from physgnn.mechanics.linear_solver import make_linear_solver
from physgnn.mechanics.loads import LoadPath
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.quasi_newton import Equilibrium, QuasiNewton
from physgnn.mechanics.rest_state import fixed_points
from physgnn.mechanics.solution import Solution, Status

FloatArray = NDArray[np.float64]


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


DEFAULT_OPTIONS = SolverOptions()


class Solver:
    """A body ready to be loaded: everything that does not depend on the load.

    Parameters
    ----------
    mesh : TetMesh
    materials : mapping of region label to Material
    fixed : str or integer array
        Name of a point set, or point indices.
    options : SolverOptions
    """

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | NDArray[np.int64] = "fixed",
        *,
        options: SolverOptions = DEFAULT_OPTIONS,
    ) -> None:
        self._mesh, self._options = mesh, options
        self._fixed = fixed_points(mesh, fixed)
        self._elements = make_elements(mesh, materials)
        self._pattern = make_pattern(mesh.cells, mesh.n_points, self._fixed)
        self._linear = make_linear_solver(
            self._pattern, precision="single", threads=options.threads
        )

    def solve(self, path: LoadPath) -> Solution:
        """Find equilibrium at every level of a path.

        Returns
        -------
        Solution
            A level that could not be reached has a status that says why.

        Raises
        ------
        InputError
            If a loaded node is missing from the mesh or fixed.
        """
        path.check_against(self._mesh, self._fixed)
        return _PathFollower(self, path).follow()

    def _iteration(self) -> QuasiNewton:
        return QuasiNewton(
            self._elements,
            self._pattern,
            self._linear,
            self._options.tolerance_mm,
            self._options.max_iterations,
        )


class _PathFollower:
    """One walk along one path."""

    def __init__(self, solver: Solver, path: LoadPath) -> None:
        self._options = solver._options
        self._path = path
        self._iteration = solver._iteration()
        force = np.zeros((solver._mesh.n_points, 3))
        force[path.nodes] = path.forces
        self._load = force[solver._pattern.free].ravel()
        self._history = PathHistory(len(self._load))

    def follow(self) -> Solution:
        started = time.perf_counter()
        n_levels, iteration = self._path.n_levels, self._iteration
        displacement = np.zeros((n_levels, iteration.elements.n_points, 3))
        status = np.full(n_levels, Status.NOT_REACHED, dtype=np.int8)
        residual = np.full(n_levels, np.nan)
        message = ""
        rest = self._history.newest[1]
        if not iteration.refactorize(rest):
            raise InputError(
                "the fixed points don't hold the body: its stiffness matrix is "
                "singular; fix at least three points that are not in line"
            )
        self._first_guess = iteration.direction(self._load)
        for level, target in enumerate(self._path.load_factors):
            found = self._advance(float(target))
            status[level] = found.status
            if found.status != Status.CONVERGED:
                message = self._explain(found)
                break
            displacement[level] = iteration.displacement(found.state)
            norm = target * np.linalg.norm(self._load)
            residual[level] = found.residual_norm / norm
        return Solution(
            displacement=displacement,
            status=status,
            residual=residual,
            load_factors=self._path.load_factors,
            reached=self._history.newest[0],
            message=message,
            seconds=time.perf_counter() - started,
            counts=dict(iteration.counts),
        )

    def _advance(self, target: float) -> Equilibrium:
        """Go to a load factor, in smaller steps where one is too long."""
        step = target - self._history.newest[0]
        while True:
            reached = self._history.newest[0]
            goal = target if reached + 1.5 * step > target else reached + step
            found = self._iteration.solve(self._guess(goal), goal * self._load)
            if found.status == Status.CONVERGED:
                self._history.add(goal, found.state)
                if goal == target:
                    return found
                step = min(2 * step, target - goal)
                continue
            step = (goal - reached) / 2
            if step < self._options.min_step:
                return found
            # The failed try may have left the factor at a useless state.
            if not self._iteration.refactorize(self._history.newest[1]):
                return Equilibrium(found.state, Status.LIMIT_POINT, np.inf)

    def _guess(self, load_factor: float) -> FloatArray:
        if len(self._history.states) == 1:
            return load_factor * self._first_guess
        return self._history.predict(load_factor)

    def _explain(self, found: Equilibrium) -> str:
        where = f" (cell {found.inverted})" if found.inverted >= 0 else ""
        return (
            f"stopped at load factor {self._history.newest[0]:.4f}: "
            f"{found.status.remedy}{where}"
        )


def solve(
    mesh: TetMesh,
    path: LoadPath,
    *,
    materials: Mapping[int, Material],
    fixed: str | NDArray[np.int64] = "fixed",
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
    options : SolverOptions

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        If the load, the materials or the fixed points don't fit the mesh.
    """
    return Solver(mesh, materials, fixed, options=options).solve(path)
