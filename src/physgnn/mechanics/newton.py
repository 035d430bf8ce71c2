"""Newton's method to the letter: the yardstick for answers found faster.

Every iteration factorises K(u) in double precision. Slow (FEBio's "full Newton"),
simple, and exact to rounding: bulk runs check a sample of their levels against it,
and benchmarks race against it.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.assembly import assemble_tangent, make_pattern
from physgnn.mechanics.element import internal_force, make_elements
from physgnn.mechanics.linear_solver import make_linear_solver
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.materials.table import Material
from physgnn.mechanics.rest_state import fixed_points

FloatArray = NDArray[np.float64]

MAX_ITERATIONS = 30
MAX_HALVINGS = 10


class Newton:
    """Full Newton on one body, in double precision.

    Parameters
    ----------
    mesh : TetMesh
    materials : mapping of region label to Material
    fixed : str or integer array
    tolerance_mm : float
        Iteration ends when no point moves further than this.
    """

    def __init__(
        self,
        mesh: TetMesh,
        materials: Mapping[int, Material],
        fixed: str | NDArray[np.int64] = "fixed",
        *,
        tolerance_mm: float = 1e-9,
    ) -> None:
        points = fixed_points(mesh, fixed)
        self._elements = make_elements(mesh, materials)
        self._pattern = make_pattern(mesh.cells, mesh.n_points, points)
        self._linear = make_linear_solver(self._pattern)
        self._tolerance_mm = tolerance_mm
        self.factorisations = 0

    def solve(self, case: LoadCase, start: FloatArray) -> FloatArray | None:
        """Return the equilibrium next to a start, or None if there is none.

        Parameters
        ----------
        case : LoadCase
        start : (n_points, 3) array
            mm.

        Returns
        -------
        (n_points, 3) array or None
        """
        u = np.array(start, dtype=np.float64)
        free, load = self._pattern.free, case.on_points(len(u))
        for _ in range(MAX_ITERATIONS):
            data, inverted = assemble_tangent(self._elements, self._pattern, u)
            if inverted >= 0 or not self._linear.factorize(data):
                return None
            self.factorisations += 1
            force, _ = internal_force(self._elements, u)
            step = np.zeros_like(u)
            right = (load - force)[free].ravel()
            step[free] = self._linear.solve(right).reshape(-1, 3)
            scale = self._longest(u, step)
            u += scale * step
            size = float(np.linalg.norm(step, axis=1).max())
            if scale == 1.0 and size < self._tolerance_mm:
                return u
        return None

    def distance(self, case: LoadCase, displacement: FloatArray) -> float:
        """Largest distance of any point from its place in equilibrium, mm.

        Infinite if Newton's method finds no equilibrium from there.
        """
        exact = self.solve(case, displacement)
        if exact is None:
            return float("inf")
        return float(np.linalg.norm(exact - displacement, axis=1).max())

    def _longest(self, u: FloatArray, step: FloatArray) -> float:
        """Return the longest of 1, ½, ¼ … of a step that inverts no cell."""
        scale = 1.0
        for _ in range(MAX_HALVINGS):
            if internal_force(self._elements, u + scale * step)[1] < 0:
                break
            scale /= 2
        return scale
