"""Equilibrium along a load path: levels asked for, steps between them as needed."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.assembly import Pattern, make_pattern
from physgnn.mechanics.body import fixed_points
from physgnn.mechanics.element import DEFAULT_ELEMENT, checked_element, make_elements
from physgnn.mechanics.linear_solver import LinearSolver, make_linear_solver
from physgnn.mechanics.loading import Loading
from physgnn.mechanics.loads import LoadPath
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.path_following import PathFollower
from physgnn.mechanics.quasi_newton import QuasiNewton
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
    element : str
        "tet4", linear tetrahedra as published, or "tet4-averaged", which do not lock
        as ν nears 0.5 (`physgnn.mechanics.averaging`).
    """

    tolerance_mm: float = 1e-4
    max_iterations: int = 40
    min_step: float = 1e-3
    threads: int = 1
    element: str = DEFAULT_ELEMENT

    def __post_init__(self) -> None:
        if not self.tolerance_mm > 0 or not 0 < self.min_step < 1:
            raise InputError(
                "tolerance_mm must be > 0 and min_step in (0, 1) "
                f"(got {self.tolerance_mm}, {self.min_step})"
            )
        checked_element(self.element)


DEFAULT_OPTIONS = SolverOptions()
SMALL_FACTOR = 2.0**-20  # a power of two: dividing by it loses nothing


@dataclass(frozen=True, eq=False)
class _Unknowns:
    """What is solved for when these points are held, and with what."""

    held: NDArray[np.int64]
    pattern: Pattern
    linear: LinearSolver


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
        self._elements = make_elements(mesh, materials, options.element)
        self._unknowns = self._find_unknowns(np.empty(0, dtype=np.int64))

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
        loading = Loading(self._mesh, path, self._fixed)
        return _follow(self._iteration(loading), path, self._options.min_step)

    def _iteration(self, loading: Loading) -> QuasiNewton:
        if not np.array_equal(self._unknowns.held, loading.held):
            self._unknowns = self._find_unknowns(loading.held)
        return QuasiNewton(
            self._elements,
            self._unknowns.pattern,
            self._unknowns.linear,
            loading,
            self._options.tolerance_mm,
            self._options.max_iterations,
        )

    def _find_unknowns(self, held: NDArray[np.int64]) -> _Unknowns:
        pattern = make_pattern(
            self._mesh.cells,
            self._mesh.n_points,
            np.union1d(self._fixed, held),
            self._elements.averaging,
        )
        linear = make_linear_solver(
            pattern, precision="single", threads=self._options.threads
        )
        return _Unknowns(held, pattern, linear)


def _follow(iteration: QuasiNewton, path: LoadPath, min_step: float) -> Solution:
    """Walk from rest along all levels of a path."""
    started = time.perf_counter()
    displacement = np.zeros((path.n_levels, iteration.elements.n_points, 3))
    status = np.full(path.n_levels, Status.NOT_REACHED, dtype=np.int8)
    residual = np.full(path.n_levels, np.nan)
    remarks = []
    slope = _slope_at_rest(iteration)
    walk = PathFollower(iteration, lambda factor: factor * slope, min_step=min_step)
    for level, target in enumerate(path.load_factors.tolist()):
        found, remark = walk.advance_or_fall(target)
        if remark:
            remarks.append(remark)
        status[level] = found.status
        if found.status != Status.CONVERGED:
            break
        displacement[level] = iteration.displacement(found.state, target)
        norm = iteration.load_norm(found.state, target)
        residual[level] = found.residual_norm / norm
    return Solution(
        displacement=displacement,
        status=status,
        residual=residual,
        load_factors=path.load_factors,
        reached=walk.reached,
        message="; ".join(remarks),
        seconds=time.perf_counter() - started,
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
