"""How the internal force curves along a direction: d²/ds² f_int(u + s v) at s = 0.

The right-hand side of the second-order term of an asymptotic expansion
(`physgnn.mechanics.reduced.expansions.asymptotic`), asked for along many directions
from few states.
"""

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.tet4 import Elements, internal_force
from physgnn.mechanics.materials.table import LAW_INDEX

STEP = 0.002  # of the largest strain, in the difference where there's no formula


class SecondVariation:
    """d²/ds² f_int(u + s v) at s = 0 for any v, from what follows from u alone.

    Neo-Hookean bodies have it in closed form; for others it is a second difference of
    the internal force.

    Parameters
    ----------
    elements : Elements
        Of any law.
    u : (n_points, 3) array
        State in which no cell is inverted, mm.
    """

    def __init__(self, elements: Elements, u: FloatArray) -> None:
        self._elements, self._u = elements, u
        self._gradients, J = spatial_gradients(elements, u)
        is_neo_hookean = (elements.law == LAW_INDEX["neo-hookean"]).all()
        self._closed = is_neo_hookean and elements.averaging is None
        lam, mu = elements.constants[:, 0], elements.constants[:, 1]
        self._lam = elements.volumes * lam
        self._p = elements.volumes * (lam * np.log(J) - mu)

    def __call__(self, v: FloatArray) -> FloatArray:
        """Return the force, (n_points, 3) N, for a direction (n_points, 3) in mm."""
        return self._formula(v) if self._closed else self._difference(v)

    def _formula(self, v: FloatArray) -> FloatArray:
        force = np.zeros_like(v)
        cells = self._elements.cells
        _neo_hookean(cells, self._gradients, self._lam, self._p, v, force)
        return force

    def _difference(self, v: FloatArray) -> FloatArray:
        edges = v[self._elements.cells[:, 1:]] - v[self._elements.cells[:, :1]]
        L = np.einsum("eai,eaj->eij", edges, self._gradients)
        step = STEP / (float(np.sqrt((L**2).sum(axis=(1, 2)).max())) + 1e-12)
        ahead, here, behind = (
            internal_force(self._elements, self._u + s * step * v)[0]
            for s in (1.0, 0.0, -1.0)
        )
        curved: FloatArray = (ahead - 2 * here + behind) / step**2
        return curved


def deformation_gradients(elements: Elements, u: FloatArray) -> FloatArray:
    """Return F of every cell at u, growth included, (n_cells, 3, 3)."""
    F: FloatArray = np.einsum("eai,eaj->eij", u[elements.cells], elements.gradients)
    F += elements.rest[:, None, None] * np.eye(3)
    return F


def spatial_gradients(
    elements: Elements, u: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return ∂N_a/∂x at u of every cell's last three corners, and det F.

    Those of the four corners add up to nothing.
    """
    F = deformation_gradients(elements, u)
    return elements.gradients[:, 1:] @ np.linalg.inv(F), np.linalg.det(F)


@njit(cache=True)
def _neo_hookean(cells, gradients, lam, p, v, force):  # type: ignore[no-untyped-def]
    """Add up S·∂N_a/∂x with S = V (2 p Lᵀ² − 2 λ tr L Lᵀ − λ tr L² I), L = ∂v/∂x.

    From P = μ F + p F⁻ᵀ, p = λ ln J − μ, along F + s L F: (ln J)′ = tr L,
    (ln J)″ = −tr L², (F⁻ᵀ)′ = −Lᵀ F⁻ᵀ, (F⁻ᵀ)″ = 2 Lᵀ² F⁻ᵀ. λ and p come times V.
    """
    L, S = np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(cells)):
        first = cells[e, 0]
        for i in range(3):
            for j in range(3):
                L[i, j] = 0.0
                for a in range(3):
                    edge = v[cells[e, a + 1], i] - v[first, i]
                    L[i, j] += edge * gradients[e, a, j]
        trace = L[0, 0] + L[1, 1] + L[2, 2]
        square = 0.0
        for i in range(3):
            for j in range(3):
                LL = L[i, 0] * L[0, j] + L[i, 1] * L[1, j] + L[i, 2] * L[2, j]
                S[j, i] = 2 * (p[e] * LL - lam[e] * trace * L[i, j])
                if i == j:
                    square += LL
        for i in range(3):
            S[i, i] -= lam[e] * square
        for a in range(3):
            for i in range(3):
                part = 0.0
                for j in range(3):
                    part += S[i, j] * gradients[e, a, j]
                force[cells[e, a + 1], i] += part
                force[first, i] -= part
