"""A load's answer to second order about the nearest known equilibrium, no iteration.

About an equilibrium ū under the load f̄, u(s) = ū + s u₁ + s² u₂ + … balances the load
f̄ + s (f − f̄) order by order, with K = K(ū) the only matrix (the asymptotic-numerical
method: Damil & Potier-Ferry 1990, Int. J. Eng. Sci. 28):

    K u₁ = f − f̄          K u₂ = −½ d²/ds² f_int(ū + s u₁) at s = 0

and s = 1 is the load asked for. With the rest state as ū this is the linear solution
and its first correction. Loads of one kind lie much nearer to one another than to
rest, so a few equilibria under their mean load, the anchors, serve all of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.learning.interface import Body
from physgnn.mechanics.assembly import assemble_tangent, make_pattern
from physgnn.mechanics.element import internal_force, make_elements
from physgnn.mechanics.linear_solver import LinearSolver, make_linear_solver
from physgnn.mechanics.second_variation import second_variation

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Expansion:
    """The terms of one load's expansion, each (n_points, 3), mm; zero where fixed.

    Attributes
    ----------
    anchor : array
        Displacement of the equilibrium expanded about.
    first, second : array
        u₁ and u₂; the answer to second order is anchor + first + second.
    """

    anchor: FloatArray
    first: FloatArray
    second: FloatArray

    @property
    def displacement(self) -> FloatArray:
        """The answer to second order."""
        return self.anchor + self.first + self.second


class Perturbation:
    """Expands loads on one body about its rest state or an anchor.

    An anchor needs no load of its own: it is in equilibrium with whatever its internal
    force is. Each is factorised when first used and its factor kept (single precision,
    ~80 MB for 9000 points).

    Parameters
    ----------
    body : Body
        What's loaded.
    anchors : (n_anchors, n_points, 3) array
        Displacements in stable equilibrium, mm; the rest state needn't be among them.
    threads : int
        Threads of the linear solver.
    """

    def __init__(self, body: Body, anchors: FloatArray, *, threads: int = 1) -> None:
        self._elements = make_elements(body.mesh, body.materials)
        self._pattern = make_pattern(body.mesh.cells, body.mesh.n_points, body.fixed)
        self._threads = threads
        rest = np.zeros((1, *body.mesh.points.shape))
        self._anchors = np.concatenate([rest, np.asarray(anchors, dtype=np.float64)])
        self._loads = np.stack([self._internal(u) for u in self._anchors])
        self._factors: dict[int, LinearSolver] = {}
        self._linear = np.stack([self.linear(load) for load in self._loads])
        self._self_work = np.einsum("kni,kni->k", self._loads, self._linear)

    def linear(self, force: FloatArray) -> FloatArray:
        """Return K₀⁻¹ f, (n_points, 3) mm, for a force field (n_points, 3) in N."""
        return self._solve(0, force)

    def nearest(self, force: FloatArray) -> int:
        """Return the anchor whose load is nearest in energy, 0 being the rest state.

        The distance is (f − f̄)·K₀⁻¹(f − f̄); its part f·K₀⁻¹f is the same for all.
        """
        work = np.tensordot(self._linear, force, axes=2)
        return int(np.argmin(self._self_work - 2 * work))

    def expand(self, force: FloatArray) -> Expansion:
        """Expand about the nearest anchor.

        Parameters
        ----------
        force : (n_points, 3) array
            N; what acts on fixed points goes into the support.
        """
        k = self.nearest(force)
        first = self._solve(k, force - self._loads[k])
        curved, _ = second_variation(self._elements, self._anchors[k], first)
        second = self._solve(k, -0.5 * curved)
        return Expansion(self._anchors[k], first, second)

    def _internal(self, u: FloatArray) -> FloatArray:
        force, inverted = internal_force(self._elements, u)
        if inverted >= 0:
            raise InputError(f"cell {inverted} is inverted in an anchor: train again")
        return force

    def _solve(self, k: int, force: FloatArray) -> FloatArray:
        if k not in self._factors:
            self._factors[k] = self._factorize(k)
        free = self._pattern.free
        u = np.zeros_like(force)
        u[free] = self._factors[k].solve(force[free].ravel()).reshape(-1, 3)
        return u

    def _factorize(self, k: int) -> LinearSolver:
        solver = make_linear_solver(
            self._pattern, precision="single", threads=self._threads
        )
        data, _ = assemble_tangent(self._elements, self._pattern, self._anchors[k])
        if not solver.factorize(data):
            raise InputError(
                "the body has no stable equilibrium to expand about: fix at least "
                "three points that are not in line, or train again"
            )
        return solver
