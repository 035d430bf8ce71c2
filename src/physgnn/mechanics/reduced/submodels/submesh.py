"""A few cells of a body, and the springs that the rest of it is to them."""

from dataclasses import dataclass, replace

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.subset import some_cells
from physgnn.mechanics.elements.tangent import Pattern, assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import Elements, internal_force, strain_energy


@dataclass(frozen=True, eq=False)
class CondensedCells:
    """A part of a body, as `energy_minimiser.minimise` takes it.

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
    """

    elements: Elements
    moving: IntArray
    pattern: Pattern
    springs: FloatArray
    stable: FloatArray

    @classmethod
    def on_springs(
        cls, elements: Elements, moving: IntArray, x: FloatArray, stiffness: FloatArray
    ) -> "CondensedCells":
        """Make the springs such that the stiffness of the whole at x is as given."""
        everywhere = np.arange(elements.n_points)
        without = np.setdiff1d(everywhere, np.intersect1d(moving, elements.cells))
        pattern = make_pattern(elements.cells, elements.n_points, without)
        loose = cls(elements, moving, pattern, np.zeros_like(stiffness), stiffness)
        return replace(loose, springs=stiffness - loose.stiffness(x))

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
        u = np.zeros((self.elements.n_points, 3))
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
    part = replace(
        some_cells(replace(elements, cells=cells), inside), n_points=len(points)
    )
    rows = pattern.row[points]
    dofs = (3 * rows[rows >= 0, None].astype(np.int64) + np.arange(3)).ravel()
    return part, np.flatnonzero(rows >= 0), dofs
