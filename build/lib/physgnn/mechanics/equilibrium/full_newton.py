"""Newton's method to the letter: the yardstick for solutions found faster.

Every iteration factorises K(u) in double precision. Slow (FEBio's "full Newton"),
simple, and exact to rounding: bulk runs check a sample of their levels against it,
and benchmarks race against it.
"""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.loads.external_force import Loading
from physgnn.mechanics.loads.paths import LoadCase, LoadPath

MAX_ITERATIONS = 30
MAX_HALVINGS = 10


class Newton:
    """Full Newton on one body, in double precision.

    Parameters
    ----------
    body : Body
        What is loaded.
    tolerance_mm : float
        Iteration ends when no point moves further than this.
    """

    def __init__(self, body: Body, *, tolerance_mm: float = 1e-9) -> None:
        self._body, self._elements = body, body.elements
        self._held: IntArray | None = None
        self._tolerance_mm = tolerance_mm
        self.factorisations = 0

    def solve(
        self, load: LoadCase | LoadPath, start: FloatArray, load_factor: float = 1.0
    ) -> FloatArray | None:
        """Return the equilibrium next to a start, or None if there is none.

        How pressure and buoyancy change with the displacement is left out of K(u):
        under them the steps contract linearly, to the same equilibrium.

        Parameters
        ----------
        load : LoadCase or LoadPath
        start : (n_points, 3) array
            mm.
        load_factor : float
            Where on the path.

        Returns
        -------
        (n_points, 3) array or None

        Raises
        ------
        InputError
            If the load does not fit the mesh, or fixed points and prescribed
            displacements together leave a part of the body free to move.
        """
        if isinstance(load, LoadCase):
            load = LoadPath(load.nodes, load.forces, np.ones(1))
        loading = Loading(self._body.mesh, load, self._body.fixed)
        if self._held is None or not np.array_equal(loading.held, self._held):
            self._hold(loading.held)
        u = np.array(start, dtype=np.float64)
        loading.place(u, load_factor)
        for _ in range(MAX_ITERATIONS):
            step = self._step(u, loading, load_factor)
            if step is None:
                return None
            scale = self._longest(u, step)
            u += scale * step
            size = float(np.linalg.norm(step, axis=1).max())
            if scale == 1.0 and size < self._tolerance_mm:
                return u
        return None

    def distance(
        self,
        load: LoadCase | LoadPath,
        displacement: FloatArray,
        load_factor: float = 1.0,
    ) -> float:
        """Largest distance of any point from its place in equilibrium, mm.

        Infinite if Newton's method finds no equilibrium from there.
        """
        exact = self.solve(load, displacement, load_factor)
        if exact is None:
            return float("inf")
        return float(np.linalg.norm(exact - displacement, axis=1).max())

    def _hold(self, held: IntArray) -> None:
        """Leave points out of the unknowns, beside the fixed ones."""
        self._pattern = self._body.pattern_under(held)
        self._linear = make_linear_solver(self._pattern)
        self._held = held

    def _step(
        self, u: FloatArray, loading: Loading, load_factor: float
    ) -> FloatArray | None:
        """Return Newton's step; None if a cell is inverted or K(u) is singular."""
        elements = loading.elements(self._elements, load_factor)
        data, inverted = assemble_tangent(elements, self._pattern, u)
        self._pattern.add_to_diagonal(data, loading.stiffness)
        if inverted >= 0 or not self._linear.factorize(data):
            return None
        self.factorisations += 1
        force, _ = internal_force(elements, u)
        right = self._pattern.unknowns(loading.force(u, load_factor) - force)
        return self._pattern.on_points(self._linear.solve(right))

    def _longest(self, u: FloatArray, step: FloatArray) -> float:
        """Return the longest of 1, ½, ¼ … of a step that inverts no cell."""
        scale = 1.0
        for _ in range(MAX_HALVINGS):
            if internal_force(self._elements, u + scale * step)[1] < 0:
                break
            scale /= 2
        return scale
