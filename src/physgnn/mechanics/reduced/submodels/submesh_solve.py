"""The cells near a load brought into equilibrium, the others staying where they are.

A network's prediction is good far from a force on a single point and poor in the few
cells under it. The submesh solve solves the equations there, with the prediction as
boundary values.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.subset import some_cells
from physgnn.mechanics.elements.tangent import Pattern, assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import Elements, internal_force, strain_energy
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.protocols import LinearSolver
from physgnn.mechanics.reduced.energy_minimiser import minimise
from physgnn.mechanics.reduced.submodels.submesh import cut_out

MIN_STEP = 1 / 64  # of the way from rest
SMALL_MM = 1e-6  # displacement that forces are linear in


def solve_submesh(
    body: Body, points: IntArray, guess: FloatArray, force: FloatArray
) -> FloatArray | None:
    """Bring some points into equilibrium, all others staying where a guess has them.

    Parameters
    ----------
    body : Body
        Of linear tetrahedra that are not averaged.
    points : integer array
        The patch. Those with cells beyond it stay too.
    guess : (n_points, 3) array
        mm.
    force : (n_points, 3) array
        N.

    Returns
    -------
    (n_points, 3) array or None
        mm; None if no equilibrium was found.
    """
    points, elements = np.unique(points), body.elements
    part, free, _ = cut_out(elements, body.pattern, points)
    inside = np.isin(elements.cells, points)
    touched = elements.cells[inside.any(axis=1) & ~inside.all(axis=1)]
    moving = np.setdiff1d(free, np.flatnonzero(np.isin(points, touched)))
    if len(moving) == 0:
        return None
    # Cells that can't change shape don't matter, and may be inverted in the guess.
    change = np.asarray(np.isin(part.cells, moving).any(axis=1), dtype=np.bool_)
    patch = _Clamped.of(some_cells(part, change), moving, guess[points])
    found = points[patch.pattern.free]
    x = _drawn(patch, force[found].ravel())
    if x is None:
        return None
    solved = guess.copy()
    solved[found] = x.reshape(-1, 3)
    return solved


@dataclass(frozen=True, eq=False)
class _Clamped:
    """A few cells whose outer points are held, as `minimise` takes them.

    Attributes
    ----------
    elements : Elements
        The cells.
    pattern : Pattern
        The tangent's pattern over the points that move; a stiffness is its values.
    linear : LinearSolver
        For stiffnesses of that pattern.
    held : (n_points, 3) array
        Displacement of the points that don't move, mm.
    """

    elements: Elements
    pattern: Pattern
    linear: LinearSolver
    held: FloatArray

    @classmethod
    def of(cls, elements: Elements, moving: IntArray, held: FloatArray) -> "_Clamped":
        """Hold all points but some."""
        others = np.setdiff1d(np.arange(elements.n_points), moving)
        pattern = make_pattern(elements.cells, elements.n_points, others)
        return cls(elements, pattern, make_linear_solver(pattern), held)

    @cached_property
    def stable(self) -> FloatArray:
        """The stiffness at rest."""
        return self._at(0.0).stiffness(np.zeros(self.pattern.n_unknowns))

    def energy(self, x: FloatArray) -> float:
        """Return the strain energy, N mm."""
        return strain_energy(self.elements, self._displacement(x))

    def force(self, x: FloatArray) -> FloatArray:
        """Return its gradient, N."""
        inner, _ = internal_force(self.elements, self._displacement(x))
        return inner[self.pattern.free].ravel()

    def stiffness(self, x: FloatArray) -> FloatArray:
        """Return its second derivative, N/mm, as the pattern's values."""
        return assemble_tangent(self.elements, self.pattern, self._displacement(x))[0]

    def solve(self, stiffness: FloatArray, force: FloatArray) -> FloatArray | None:
        """Return K⁻¹ f, None if K is not positive definite."""
        return self.linear.solve(force) if self.linear.factorize(stiffness) else None

    def pull(self) -> FloatArray:
        """Return the unknowns as what is held pulls them along, by linear response."""
        tiny = SMALL_MM / max(float(np.abs(self.held).max()), SMALL_MM)
        pulled = self._at(tiny).force(np.zeros(self.pattern.n_unknowns)) / tiny
        response = self.solve(self.stable, -pulled)
        return np.zeros_like(pulled) if response is None else response

    def minimum(
        self, fraction: float, load: FloatArray, start: FloatArray
    ) -> FloatArray | None:
        """Return the equilibrium at a fraction of load and held displacement."""
        body = self._at(fraction)
        if not np.isfinite(body.energy(start)):
            return None
        found = minimise(body, fraction * load, start, solve=body.solve)
        return found.x if found.converged else None

    def _at(self, fraction: float) -> "_Clamped":
        return replace(self, held=fraction * self.held)

    def _displacement(self, x: FloatArray) -> FloatArray:
        u = self.held.copy()
        u[self.pattern.free] = x.reshape(-1, 3)
        return u


def _drawn(patch: _Clamped, load: FloatArray) -> FloatArray | None:
    """Let load and held points' displacement grow from nothing, at once if it goes."""
    x, way = np.zeros_like(load), patch.pull()
    done, step = 0.0, 1.0
    while done < 1.0:
        fraction = min(done + step, 1.0)
        found = patch.minimum(fraction, load, x + (fraction - done) * way)
        if found is None:
            step /= 2
            if step < MIN_STEP:
                return None
            continue
        x, done = found, fraction
    return x
