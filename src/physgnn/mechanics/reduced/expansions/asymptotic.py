"""The solution under a load to second order about the nearest anchor, no iteration.

About an equilibrium ū under the load f̄, u(s) = ū + s u₁ + s² u₂ + … balances the load
f̄ + s (f − f̄) order by order, with K = K(ū) the only matrix (the asymptotic-numerical
method: Damil & Potier-Ferry 1990, Int. J. Eng. Sci. 28):

    K u₁ = f − f̄          K u₂ = −½ d²/ds² f_int(ū + s u₁) at s = 0

and s = 1 is the load asked for. Of the third order there is, if wanted, the part that
finite rotation and strain bring (`exponential`). With the rest state as ū, u₁ is the
linear solution. Expected loads lie much nearer to one another than to rest, so a few
equilibria among them, the anchors, serve all of them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.second_variation import SecondVariation
from physgnn.mechanics.elements.subset import some_cells
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.linear.direct_solver import factorized
from physgnn.mechanics.reduced.expansions.exponential import (
    ExponentialTerm,
    GradientFit,
)
from physgnn.mechanics.reduced.expansions.point_responses import PointResponses
from physgnn.mechanics.reduced.expansions.recently_used import RecentlyUsed

ROUNDING = 1e-3  # of the largest nodal force of an anchor: less is on no loaded point


@dataclass(frozen=True, eq=False)
class Expansion:
    """The terms of one load's expansion, each (n_points, 3), mm; zero where fixed.

    Attributes
    ----------
    anchor : array
        Displacement of the equilibrium expanded about.
    first, second : array
        u₁ and u₂; the solution to second order is anchor + first + second.
    third : array
        What finite rotation and strain add, of third order; zero if not wanted.
    """

    anchor: FloatArray
    first: FloatArray
    second: FloatArray
    third: FloatArray

    @property
    def displacement(self) -> FloatArray:
        """The solution, to second order or better."""
        return self.anchor + self.first + self.second + self.third


class AsymptoticExpansion:
    """Expands loads on one body about its rest state or an anchor.

    An anchor needs no load of its own: it is in equilibrium with whatever its internal
    force is. Each is factorised when first used, and cached with its factor (single
    precision, ~100 MB for 10,000 points) and its responses to loads on the points where
    the anchors' own loads act; of more than ``PHYSGNN_CACHE_GB`` holds, those used most
    recently.

    Parameters
    ----------
    body : Body
        What's loaded.
    anchors : (n_anchors, n_points, 3) array
        Displacements in stable equilibrium, mm; the rest state needn't be among them.
    strained : (n_points,) boolean array, optional
        Where loads may strain the body much: expansions then have a third term, which
        the cells there bring. By default there is none.
    threads : int
        Threads of the linear solver.
    """

    def __init__(
        self,
        body: Body,
        anchors: FloatArray,
        *,
        strained: BoolArray | None = None,
        threads: int = 1,
    ) -> None:
        rest = np.zeros((1, *body.mesh.points.shape))
        states = np.concatenate([rest, np.asarray(anchors, dtype=np.float64)])
        self._loads = np.stack([_internal(body, u) for u in states])
        free = body.pattern.free
        nodes = free[_loaded(self._loads[:, free])]
        self._responses: RecentlyUsed[ExpansionPoint, PointResponses] = RecentlyUsed(
            lambda about: _responses(body, about.u, nodes, threads),
            lambda responses: responses.n_bytes,
        )
        self._about = [
            ExpansionPoint(body, u, load, nodes, self._responses)
            for u, load in zip(states, self._loads, strict=True)
        ]
        self._thirds: list[ExponentialTerm] = []
        if strained is not None:
            cells = strained[body.elements.cells].any(axis=1)
            some = some_cells(body.elements, np.asarray(cells))
            fit = GradientFit(body.elements, free, threads=threads)
            self._thirds = [ExponentialTerm(some, u, fit) for u in states]
        self._linear = self._about[0].solve(self._loads)
        self._self_work = np.einsum("kni,kni->k", self._loads, self._linear)

    def linear(self, force: FloatArray) -> FloatArray:
        """Return K₀⁻¹ f, (n_points, 3) mm, for a force field (n_points, 3) in N."""
        return self._about[0].first(force)

    def nearest(self, force: FloatArray) -> int:
        """Return the anchor whose load is nearest in energy, 0 being the rest state.

        The distance is (f − f̄)·K₀⁻¹(f − f̄); its part f·K₀⁻¹f is the same for all.
        """
        loaded = np.flatnonzero(force.any(axis=1))
        work = np.einsum("kni,ni->k", self._linear[:, loaded], force[loaded])
        return int(np.argmin(self._self_work - 2 * work))

    def about(self, force: FloatArray) -> "ExpansionPoint":
        """Return the equilibrium that a load is expanded about."""
        return self._about[self.nearest(force)]

    def expand(self, force: FloatArray) -> Expansion:
        """Expand about the nearest anchor.

        Parameters
        ----------
        force : (n_points, 3) array
            N; what acts on fixed points goes into the support.
        """
        nearest = self.nearest(force)
        about = self._about[nearest]
        first = about.first(force)
        second, third = about.second(first), np.zeros_like(first)
        if self._thirds:
            third = self._thirds[nearest](first, second)
        return Expansion(about.u, first, second, third)


class ExpansionPoint:
    """A state to expand about; what that takes is made when first asked for."""

    def __init__(
        self,
        body: Body,
        u: FloatArray,
        load: FloatArray,
        nodes: IntArray,
        responses: Callable[["ExpansionPoint"], PointResponses],
    ) -> None:
        self.u = u
        self._body, self._make_responses = body, responses
        self._load = np.zeros_like(load)
        self._load[nodes] = load[nodes]
        self._elsewhere = load - self._load  # rounding, if the anchors' loads are alike

    def first(self, force: FloatArray) -> FloatArray:
        """Return u₁ for a load's force field."""
        return self._responses(force - self._load) - self._offset

    def second(self, first: FloatArray) -> FloatArray:
        """Return u₂ for a first term."""
        return self.solve(-0.5 * self.curvature(first))

    def solve(self, force: FloatArray) -> FloatArray:
        """Return K⁻¹ f of one force field or several, (…, n_points, 3)."""
        return self._responses.solve(force)

    @property
    def _responses(self) -> PointResponses:
        return self._make_responses(self)

    @cached_property
    def _offset(self) -> FloatArray:
        return self.solve(self._elsewhere)

    @cached_property
    def curvature(self) -> SecondVariation:
        """How the internal force curves about it."""
        return SecondVariation(self._body.elements, self.u)


def _responses(
    body: Body, u: FloatArray, nodes: IntArray, threads: int
) -> PointResponses:
    solver = factorized(body, u, precision="single", threads=threads)
    if solver is None:
        raise InputError(
            "the body has no stable equilibrium to expand about: fix at least "
            "three points that are not in line, or train again"
        )
    return PointResponses(solver, body.pattern, nodes)


def _internal(body: Body, u: FloatArray) -> FloatArray:
    force, inverted = internal_force(body.elements, u)
    if inverted >= 0:
        raise InputError(f"cell {inverted} is inverted in an anchor: train again")
    return force


def _loaded(loads: FloatArray) -> BoolArray:
    """Return which points carry any of the loads (n_loads, n, 3), rounding aside."""
    size = np.abs(loads).max(axis=2)
    largest = size.max(axis=1, keepdims=True)
    carries: BoolArray = (size > ROUNDING * largest).any(axis=0)
    return carries
