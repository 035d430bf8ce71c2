"""A few cells of a body, held by springs or by their neighbours' displacement."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from physgnn.mechanics.assembly import Pattern, assemble_tangent, make_pattern
from physgnn.mechanics.dense_newton import minimise
from physgnn.mechanics.element import Elements, internal_force, strain_energy

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MIN_STEP = 1 / 64  # of the way from rest
SMALL_MM = 1e-6  # displacement that forces are linear in


@dataclass(frozen=True, eq=False)
class Patch:
    """A part of a body as `physgnn.mechanics.dense_newton.minimise` takes it.

    Attributes
    ----------
    elements : Elements
        Its cells, with its own numbers of points.
    moving : integer array
        Its points that are unknown.
    pattern : Pattern
        Of its own cells' stiffness; points without such cells are left out.
    springs : (n, n) array
        S over the unknowns, N/mm: what holds it beside its own cells.
    stable : (n, n) array
        A positive definite stiffness of all.
    held : (n_points, 3) array
        Displacement of the points that are not unknown, mm.
    """

    elements: Elements
    moving: IntArray
    pattern: Pattern
    springs: FloatArray
    stable: FloatArray
    held: FloatArray

    @classmethod
    def on_springs(
        cls, elements: Elements, moving: IntArray, x: FloatArray, stiffness: FloatArray
    ) -> "Patch":
        """Make the springs such that the stiffness of the whole at x is as given."""
        loose = cls._held(elements, moving, np.zeros((elements.n_points, 3)))
        springs = stiffness - loose.stiffness(x)
        return replace(loose, springs=springs, stable=stiffness)

    @classmethod
    def clamped(cls, elements: Elements, moving: IntArray, held: FloatArray) -> "Patch":
        """Hold the other points where they are displaced to."""
        patch = cls._held(elements, moving, held)
        at_rest = replace(patch, held=np.zeros_like(held))
        return replace(patch, stable=at_rest.stiffness(np.zeros(3 * len(moving))))

    @classmethod
    def _held(cls, elements: Elements, moving: IntArray, held: FloatArray) -> "Patch":
        everywhere = np.arange(elements.n_points)
        unknown = np.intersect1d(moving, elements.cells)
        pattern = make_pattern(
            elements.cells, elements.n_points, np.setdiff1d(everywhere, unknown)
        )
        nothing = np.zeros((3 * len(moving), 3 * len(moving)))
        return cls(elements, moving, pattern, nothing, nothing, held)

    def smooth(self) -> FloatArray:
        """Return the unknowns as what is held pulls them along, by linear response."""
        at_rest = replace(self, held=np.zeros_like(self.held))
        nothing = np.zeros(3 * len(self.moving))
        tiny = SMALL_MM / max(float(np.abs(self.held).max()), SMALL_MM)
        pulled = replace(self, held=tiny * self.held).force(nothing) / tiny
        push = at_rest.force(nothing) / tiny - pulled
        return np.linalg.solve(self.stable, push).astype(np.float64)

    def energy(self, x: FloatArray) -> float:
        """Return the energy of cells and springs, N mm."""
        own = strain_energy(self.elements, self._displacement(x))
        return own + 0.5 * float(x @ self.springs @ x)

    def force(self, x: FloatArray) -> FloatArray:
        """Return its gradient, N."""
        own, _ = internal_force(self.elements, self._displacement(x))
        total: FloatArray = own[self.moving].ravel() + self.springs @ x
        return total

    def stiffness(self, x: FloatArray) -> FloatArray:
        """Return its second derivative, N/mm."""
        own, _ = assemble_tangent(self.elements, self.pattern, self._displacement(x))
        at = np.searchsorted(self.moving, self.pattern.free)
        at = (3 * at[:, None] + np.arange(3)).ravel()
        row, column = at.repeat(np.diff(self.pattern.indptr)), at[self.pattern.indices]
        K = self.springs.copy()
        K[row, column] += own
        off_diagonal = row != column
        K[column[off_diagonal], row[off_diagonal]] += own[off_diagonal]
        return K

    def _displacement(self, x: FloatArray) -> FloatArray:
        u = self.held.copy()
        u[self.moving] = x.reshape(-1, 3)
        return u


def cut_out(
    elements: Elements, pattern: Pattern, points: IntArray
) -> tuple[Elements, IntArray, IntArray]:
    """Return the cells among some points, which of these move, and their unknowns."""
    points = np.unique(points)
    place = np.full(elements.n_points, -1, dtype=np.int32)
    place[points] = np.arange(len(points), dtype=np.int32)
    inside = np.asarray((place[elements.cells] >= 0).all(axis=1), dtype=np.bool_)
    cells = np.ascontiguousarray(place[elements.cells])
    part = replace(_some(replace(elements, cells=cells), inside), n_points=len(points))
    rows = pattern.row[points]
    dofs = (3 * rows[rows >= 0, None].astype(np.int64) + np.arange(3)).ravel()
    return part, np.flatnonzero(rows >= 0), dofs


def _some(elements: Elements, cells: NDArray[np.bool_]) -> Elements:
    return replace(
        elements,
        cells=np.ascontiguousarray(elements.cells[cells]),
        gradients=elements.gradients[cells],
        volumes=elements.volumes[cells],
        law=elements.law[cells],
        constants=elements.constants[cells],
    )


def settle(
    elements: Elements,
    pattern: Pattern,
    points: IntArray,
    guess: FloatArray,
    force: FloatArray,
) -> FloatArray | None:
    """Bring some points into equilibrium, all others staying where a guess has them.

    Parameters
    ----------
    elements, pattern : Elements, Pattern
        Of the whole body; linear tetrahedra that are not averaged.
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
    points = np.unique(points)
    part, free, _ = cut_out(elements, pattern, points)
    inside = np.isin(elements.cells, points)
    touched = elements.cells[inside.any(axis=1) & ~inside.all(axis=1)]
    moving = np.setdiff1d(free, np.flatnonzero(np.isin(points, touched)))
    # Cells that can't change shape don't matter, and may be inverted in the guess.
    change = np.asarray(np.isin(part.cells, moving).any(axis=1), dtype=np.bool_)
    part = _some(part, change)
    patch = Patch.clamped(part, moving, guess[points])
    x = _drawn(patch, force[points[moving]].ravel())
    if x is None:
        return None
    settled = guess.copy()
    settled[points[moving]] = x.reshape(-1, 3)
    return settled


def _drawn(patch: Patch, load: FloatArray) -> FloatArray | None:
    """Let load and held points' displacement grow from nothing, at once if it goes."""
    x, way = np.zeros_like(load), patch.smooth()
    done, step = 0.0, 1.0
    while done < 1.0:
        share = min(done + step, 1.0)
        found = _minimum(
            replace(patch, held=share * patch.held),
            share * load,
            x + (share - done) * way,
        )
        if found is None:
            step /= 2
            if step < MIN_STEP:
                return None
            continue
        x, done = found, share
    return x


def _minimum(patch: Patch, load: FloatArray, start: FloatArray) -> FloatArray | None:
    if not np.isfinite(patch.energy(start)):
        return None
    found = minimise(patch, load, start)
    return found.x if found.converged else None
