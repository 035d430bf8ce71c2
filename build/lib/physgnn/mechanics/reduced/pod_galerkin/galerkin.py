"""Equilibrium in a small space: points near the loads, POD modes everywhere else.

u = E w + Φ q, with E the unknowns of a few points, free to move as they like, and Φ
modes that are zero there. Energy is that of a few weighted cells
(`physgnn.mechanics.reduced.pod_galerkin.ecsw`), among them all that touch the points.
"""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.tangent import assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import Elements, internal_force, strain_energy
from physgnn.mechanics.reduced.energy_minimiser import Minimum, minimise


class GalerkinBody:
    """A body in a small space; it is what `energy_minimiser.minimise` asks for.

    Parameters
    ----------
    elements : Elements
        Of the whole body, not averaged.
    weights : (n_cells,) array
        Of every cell, ≥ 0; those of weight zero are left out.
    points : integer array
        Points that are unknowns themselves; none is fixed, and all have a cell with a
        weight.
    modes : (n_modes, n_points, 3) array
        Zero at these points and the fixed ones. Those that are zero everywhere, as
        `leading_modes` fills up with, are left out: K would be singular.
    """

    def __init__(
        self,
        elements: Elements,
        weights: FloatArray,
        points: IntArray,
        modes: FloatArray,
    ) -> None:
        modes = modes[modes.any(axis=(1, 2))]
        self._points, self._modes = points, modes
        used_cells = np.flatnonzero(weights)
        used = np.unique(elements.cells[used_cells])
        place = np.full(elements.n_points, -1, dtype=np.int32)
        place[used] = np.arange(len(used), dtype=np.int32)
        self._elements = replace(
            elements,
            cells=place[elements.cells[used_cells]],
            gradients=elements.gradients[used_cells],
            rest=elements.rest[used_cells],
            volumes=elements.volumes[used_cells] * weights[used_cells],
            law=elements.law[used_cells],
            constants=elements.constants[used_cells],
            n_points=len(used),
        )
        none = np.empty(0, dtype=np.int64)
        self._pattern = make_pattern(self._elements.cells, len(used), none)
        self._own = place[points]
        self._shapes = modes[:, used].reshape(len(modes), 3 * len(used)).T.copy()
        self.stable = self.stiffness(np.zeros(self.n_unknowns))

    @property
    def n_unknowns(self) -> int:
        """Three for every point, one for every mode."""
        return 3 * len(self._points) + len(self._modes)

    def solve(self, force: FloatArray) -> tuple[FloatArray, Minimum]:
        """Return the displacement under forces (n_points, 3), and how it was found."""
        along_modes = np.tensordot(self._modes, force, axes=2)
        load = np.concatenate([force[self._points].ravel(), along_modes])
        found = minimise(self, load, np.zeros(self.n_unknowns))
        w, q = np.split(found.x, [3 * len(self._points)])
        u = np.tensordot(q, self._modes, axes=1)
        u[self._points] += w.reshape(-1, 3)
        return u, found

    def energy(self, x: FloatArray) -> float:
        """Return the weighted cells' strain energy, N mm."""
        return strain_energy(self._elements, self._displacement(x))

    def force(self, x: FloatArray) -> FloatArray:
        """Return its gradient, N."""
        inner, _ = internal_force(self._elements, self._displacement(x))
        return np.concatenate(
            [inner[self._own].ravel(), self._shapes.T @ inner.ravel()]
        )

    def stiffness(self, x: FloatArray) -> FloatArray:
        """Return its second derivative, N/mm."""
        data, _ = assemble_tangent(self._elements, self._pattern, self._displacement(x))
        n = self._pattern.n_unknowns
        upper = sp.csr_array(
            (data, self._pattern.indices, self._pattern.indptr), shape=(n, n)
        )
        K = upper + sp.triu(upper, 1).T
        own = (3 * self._own[:, None] + np.arange(3)).ravel()
        stiffened = K @ self._shapes
        return np.block(
            [
                [K.tocsr()[own][:, own].toarray(), stiffened[own]],
                [stiffened[own].T, self._shapes.T @ stiffened],
            ]
        )

    def _displacement(self, x: FloatArray) -> FloatArray:
        w, q = np.split(x, [3 * len(self._own)])
        u: FloatArray = (self._shapes @ q).reshape(-1, 3)
        u[self._own] += w.reshape(-1, 3)
        return u
