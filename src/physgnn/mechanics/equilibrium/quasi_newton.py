"""Equilibrium at one load: a cached factorisation, sharpened by secant pairs.

Newton's method needs a factorisation an iteration; here one factor serves several
load levels. It is in single precision (residuals are in double, so the solution is
not), and limited-memory BFGS (Nocedal & Wright, *Numerical Optimization*, 2nd
ed., algorithm 7.4) corrects it with what the iteration itself learns. When that no
longer pays the factor is renewed: of a large body where it has deformed most, and as a
whole only where that was not enough.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import Pattern, assemble_tangent
from physgnn.mechanics.elements.tet4 import Elements, internal_force
from physgnn.mechanics.equilibrium.norms import dot, largest_norm, norm
from physgnn.mechanics.equilibrium.partial_renewal import (
    LEAST_UNKNOWNS,
    PartialRenewal,
    worn_out,
)
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.linear.protocols import Factor, LinearSolver
from physgnn.mechanics.loads.external_force import Loading

MAX_PAIRS = 12
MAX_TRIALS = 12
OVERSHOT = 1.0  # a step too long: it is pulled back harder than it was pulled
# What a step with the factor of the very state leaves of the error. Seen were 0.04 of
# steps of 0.05 mm, less than 0.01 of those below 0.02 mm; tolerances are far smaller.
NEWTON_CONTRACTION = 0.1


@dataclass
class Equilibrium:
    """Where an iteration ended."""

    state: FloatArray
    status: Status
    residual_norm: float
    inverted: int = -1


@dataclass
class QuasiNewton:
    """Solves f_ext(u) − f_int(u) = 0 over the free unknowns, many times in a row.

    The residual has every load in it exactly; the factor leaves out how a load changes
    with u, which the secant pairs learn.

    Parameters
    ----------
    body : Body
        What is loaded.
    pattern : Pattern
        Of the tangent over the points that are free under the load.
    solver : LinearSolver
        Solves with tangents of that pattern.
    loading : Loading
        The loads.
    tolerance_mm : float
        Bound on the estimated displacement error of the worst point.
    max_iterations : int
        A load.
    threads : int
        Of the linear solver.
    force : callable
        As `internal_force`, which it is unless states with inverted cells must have
        one too.
    """

    body: Body
    pattern: Pattern
    solver: LinearSolver
    loading: Loading
    tolerance_mm: float
    max_iterations: int
    threads: int = 1
    force: Callable[[Elements, FloatArray], tuple[FloatArray, int]] = internal_force
    counts: dict[str, int] = field(
        default_factory=lambda: dict.fromkeys(
            ("factorisations", "partial_renewals", "back_solves", "residuals"), 0
        )
    )

    @property
    def elements(self) -> Elements:
        """The body's elements, before any growth."""
        return self.body.elements

    def __post_init__(self) -> None:
        self._pairs: list[tuple[FloatArray, FloatArray]] = []
        self._contraction = 0.5
        self._part: PartialRenewal | None = None
        self._factor_at = np.zeros((self.elements.n_points, 3))

    def displacement(self, state: FloatArray, load_factor: float) -> FloatArray:
        """Spread the free unknowns over all points, (n_points, 3)."""
        u = np.zeros((self.elements.n_points, 3))
        u[self.pattern.free] = state.reshape(-1, 3)
        self.loading.place(u, load_factor)
        return u

    def residual(self, state: FloatArray, load_factor: float) -> tuple[FloatArray, int]:
        """Return load − internal force of the free unknowns, and any inverted cell."""
        self.counts["residuals"] += 1
        u = self.displacement(state, load_factor)
        elements = self.loading.elements(self.elements, load_factor)
        force, inverted = self.force(elements, u)
        load = self.loading.force(u, load_factor)
        return (load - force)[self.pattern.free].ravel(), inverted

    def load_norm(self, state: FloatArray, load_factor: float) -> float:
        """Norm of all forces, of growth and on points put in place included, N."""
        u = self.displacement(state, load_factor)
        load = self.loading.force(u, load_factor)
        load += self.loading.growth_force(self.elements, u, load_factor)
        load = load[self.pattern.free].ravel()
        if len(self.loading.held) == 0:
            return norm(load)
        grown = self.loading.elements(self.elements, load_factor)
        force, _ = internal_force(grown, u)
        return norm(np.concatenate([load, force[self.loading.held].ravel()]))

    def refactorize(self, state: FloatArray, load_factor: float) -> bool:
        """Factorise K(u) and forget the pairs; False if K is not positive definite."""
        u = self.displacement(state, load_factor)
        elements = self.loading.elements(self.elements, load_factor)
        data, inverted = assemble_tangent(elements, self.pattern, u)
        if inverted >= 0:
            return False
        self.counts["factorisations"] += 1
        self._pairs.clear()
        self._part, self._factor_at = None, u
        self.pattern.add_to_diagonal(data, self.loading.stiffness)
        return self.solver.factorize(data)

    def begin_with(
        self, factor: Factor, factor_at: FloatArray, state: FloatArray
    ) -> bool:
        """Begin with a factor of another state, renewed in part, if that pays.

        Parameters
        ----------
        factor : Factor
            Of the tangent at another state.
        factor_at : (n_points, 3) array
            That state's displacement, mm.
        state : (n_unknowns,) array
            Where the iteration begins, at load factor 1.

        Returns
        -------
        bool
            False if the body is small, or the part's tangent not positive definite.
        """
        if len(state) < LEAST_UNKNOWNS:
            return False
        self._part, self._factor_at = None, factor_at
        return self.renew_part(state, 1.0, factor)

    def renew_part(
        self, state: FloatArray, load_factor: float, whole: Factor | None = None
    ) -> bool:
        """Bring the factor up to date where the body has deformed most since.

        Parameters
        ----------
        state : (n_unknowns,) array
        load_factor : float
        whole : Factor, optional
            Of an earlier state, in place of the iteration's own.

        Returns
        -------
        bool
            False if K is not positive definite there.
        """
        u = self.displacement(state, load_factor)
        self.counts["partial_renewals"] += 1
        self._pairs.clear()
        if self._part is None:
            change = u - self._factor_at
            whole = self.solver if whole is None else whole
            self._part = PartialRenewal(
                self.elements, self.pattern, whole, change, threads=self.threads
            )
        elements = self.loading.elements(self.elements, load_factor)
        return self._part.renew(elements, u, self.loading.stiffness)

    def direction(self, residual: FloatArray) -> FloatArray:
        """Apply the L-BFGS inverse to a residual (two-loop recursion)."""
        q = residual.copy()
        weights = []
        for s, y in reversed(self._pairs):
            weight = dot(s, q) / dot(s, y)
            q -= weight * y
            weights.append(weight)
        self.counts["back_solves"] += 1
        d = (self._part or self.solver).solve(q)
        for (s, y), weight in zip(self._pairs, reversed(weights), strict=True):
            d += s * (weight - dot(y, d) / dot(s, y))
        return d

    def solve(
        self,
        start: FloatArray,
        load_factor: float,
        *,
        tolerance_mm: float | None = None,
    ) -> Equilibrium:
        """Iterate from a start to equilibrium at a load factor.

        Parameters
        ----------
        start : (n_unknowns,) array
        load_factor : float
        tolerance_mm : float, optional
            In place of the iteration's own.
        """
        tolerance_mm = self.tolerance_mm if tolerance_mm is None else tolerance_mm
        state = start
        r, inverted = self.residual(state, load_factor)
        if inverted >= 0:
            return Equilibrium(state, Status.INVERTED, np.inf, inverted)
        previous, since_factor, fresh = np.inf, 0, False
        partial = len(r) >= LEAST_UNKNOWNS  # once a load: then the rest has changed
        for _ in range(self.max_iterations):
            d = self.direction(r)
            moved, r_new, scale, inverted = self._step(state, d, r, load_factor)
            if scale == 0.0:
                if fresh or not self.refactorize(state, load_factor):
                    return Equilibrium(state, Status.INVERTED, norm(r), inverted)
                previous, since_factor, fresh = np.inf, 0, True
                continue
            self.remember(scale * d, r - r_new)
            state, r = moved, r_new
            size = scale * largest_norm(d)
            left = self.error_left(size, previous, fresh=fresh)
            if scale == 1.0 and left < tolerance_mm:
                return Equilibrium(state, Status.CONVERGED, norm(r))
            since_factor += 1
            fresh = False
            if worn_out(size, previous, since_factor, partial=partial):
                fresh = not partial
                renew = self.refactorize if fresh else self.renew_part
                if not renew(state, load_factor):
                    return Equilibrium(state, Status.LIMIT_POINT, norm(r))
                size, since_factor, partial = np.inf if fresh else size, 0, False
            previous = size
        return Equilibrium(state, Status.ITERATION_LIMIT, norm(r))

    def _step(
        self, state: FloatArray, d: FloatArray, r: FloatArray, load_factor: float
    ) -> tuple[FloatArray, FloatArray, float, int]:
        """Take d, or as much of it as inverts no cell and doesn't overshoot.

        Forces pull back where d has gone too far; the new length is where they would
        neither pull nor push, were they linear along d (secant).
        """
        scale, inverted, pull = 1.0, -1, dot(d, r)
        for _ in range(MAX_TRIALS):
            moved = state + scale * d
            r_new, bad = self.residual(moved, load_factor)
            if bad >= 0:
                inverted = bad
                scale /= 2
                continue
            pull_new = dot(d, r_new)
            if pull_new > -OVERSHOT * pull:
                return moved, r_new, scale, inverted
            scale *= max(pull / (pull - pull_new), 0.1)
        return state, r, 0.0, inverted

    def remember(self, s: FloatArray, y: FloatArray) -> None:
        """Keep a step and what it took off the residual, for directions to come."""
        # Only pairs of positive curvature keep the inverse positive definite.
        if dot(s, y) > 1e-12 * np.sqrt(dot(s, s) * dot(y, y)):
            self._pairs.append((s, y))
            del self._pairs[:-MAX_PAIRS]

    def error_left(self, size: float, previous: float, *, fresh: bool = False) -> float:
        """Estimate the error left from how the steps contract, mm; on the safe side.

        A step with a fresh factor, that of the state it began at, is Newton's own.
        """
        if fresh:
            self._contraction = NEWTON_CONTRACTION
            return NEWTON_CONTRACTION * size
        contraction = min(size / previous, 0.9)
        # One lucky step proves little: the slower of this and the last contraction
        # counts, whether that was seen at this load or at the one before.
        slower = max(contraction, self._contraction, 0.4)
        self._contraction = contraction if np.isfinite(previous) else slower
        return 2 * size * slower / (1 - slower)
