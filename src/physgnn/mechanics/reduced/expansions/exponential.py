"""What an expansion to second order leaves out of finite rotation and strain.

u₁ + u₂ turns and stretches cells along straight lines, so that they swell and invert
under strong loads. The logarithm of the deformation gradient has a series, too:

    log(F F̄⁻¹) = L₁ + L₂ − ½ L₁² + …,       Lᵢ = ∂uᵢ/∂x̄,

x̄ being where points are at the anchor ū. Cut there, its exponential turns a cell
without swelling it, and inverts none. But it is no displacement's gradient, so the
displacement is taken whose gradient comes nearest, in least squares over the volume at
rest. It is u₁ + u₂ and a term of third order in the load. (Deformation from rotations
and strains: Choi & Ko 2005, IEEE Trans. Vis. Comput. Graph. 11, 91–101; Huang et al.
2011, Proc. SIGGRAPH/Eurographics Symp. Comput. Animation, 177–184.)
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.second_variation import (
    deformation_gradients,
    spatial_gradients,
)
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.mechanics.linear.direct_solver import make_linear_solver

SMALL = 0.05  # |L|: below it a cell's part is of 2e-5, not worth its time
LARGE = 2.0  # of the exponent at most: seven times as long; beyond, series mean nothing
HALVINGS = 4  # of the exponent; then a polynomial of third order is exact to 1e-6


class GradientFit:
    """Finds the displacement, zero where fixed, with the gradient nearest to a given.

    Parameters
    ----------
    elements : Elements
    free : (n_free,) integer array
        Points that are not fixed.
    threads : int
        Of the linear solver.
    """

    def __init__(self, elements: Elements, free: IntArray, *, threads: int = 1) -> None:
        self._free = free
        pattern, values = _laplacian(elements, free)
        self._solver = make_linear_solver(pattern, precision="single", threads=threads)
        self._solver.factorize(values)

    def __call__(self, divergence: FloatArray) -> FloatArray:
        """Return the displacement, (n_points, 3) mm.

        Parameters
        ----------
        divergence : (n_points, 3) array
            ∫ G ∂N/∂X dV of the gradient G that is given, mm².
        """
        fitted = np.zeros_like(divergence)
        fitted[self._free] = self._solver.solve(divergence[self._free].T).T
        return fitted


class ExponentialTerm:
    """The term of third order, about one anchor.

    Parameters
    ----------
    elements : Elements
        Of the body, or those of its cells that are strained much.
    u : (n_points, 3) array
        The anchor's displacement, mm.
    fit : GradientFit
        The body's.
    """

    def __init__(self, elements: Elements, u: FloatArray, fit: GradientFit) -> None:
        self._fit = fit
        self._cells, self._gradients = elements.cells, spatial_gradients(elements, u)[0]
        F = deformation_gradients(elements, u)
        # F̄ V ∂N/∂X: what G = (exp − 1 − L₁ − L₂) F̄ is multiplied with and added up
        weights = elements.volumes[:, None, None] * elements.gradients[:, 1:]
        self._weights = np.einsum("eij,eaj->eai", F, weights)

    def __call__(self, first: FloatArray, second: FloatArray) -> FloatArray:
        """Return what u₁ and u₂ are to be added, (n_points, 3) mm."""
        divergence = np.zeros_like(first)
        _add_up(self._cells, self._gradients, self._weights, first, second, divergence)
        return self._fit(divergence)


@dataclass(frozen=True, eq=False)
class _ScalarPattern:
    """The upper triangle of a matrix with one unknown a free point."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    n_unknowns: int


def _laplacian(elements: Elements, free: IntArray) -> tuple[_ScalarPattern, FloatArray]:
    """Return ∫ ∂N_a/∂X · ∂N_b/∂X dV of the free points, mm."""
    weighted = elements.volumes[:, None, None] * elements.gradients
    blocks = np.einsum("eai,ebi->eab", weighted, elements.gradients)
    row, column = np.repeat(elements.cells, 4, axis=1), np.tile(elements.cells, 4)
    n = elements.n_points
    whole = sp.coo_array((blocks.ravel(), (row.ravel(), column.ravel())), shape=(n, n))
    upper = sp.triu(whole.tocsr()[free][:, free], format="csr")
    upper.sort_indices()
    starts, columns = (np.asarray(a, np.int32) for a in (upper.indptr, upper.indices))
    return _ScalarPattern(starts, columns, len(free)), upper.data


@njit(cache=True)
def _add_up(cells, gradients, weights, first, second, divergence):  # type: ignore[no-untyped-def]
    """Add up (exp(L₁ + L₂ − ½ L₁²) − 1 − L₁ − L₂) F̄ V ∂N_a/∂X over the cells."""
    L1, L, M = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    bent, scratch = np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(cells)):
        corner, size = cells[e, 0], 0.0
        for i in range(3):
            for j in range(3):
                one, two = 0.0, 0.0
                for a in range(3):
                    to = cells[e, a + 1]
                    one += (first[to, i] - first[corner, i]) * gradients[e, a, j]
                    two += (second[to, i] - second[corner, i]) * gradients[e, a, j]
                L1[i, j], L[i, j] = one, one + two
                size += (one + two) ** 2
        if size < SMALL**2:
            continue
        size = 0.0
        for i in range(3):
            for j in range(3):
                square = L1[i, 0] * L1[0, j] + L1[i, 1] * L1[1, j] + L1[i, 2] * L1[2, j]
                M[i, j] = L[i, j] - 0.5 * square
                size += M[i, j] ** 2
        if size > LARGE**2:
            M *= LARGE / np.sqrt(size)
        _exponential(M, bent, scratch)
        for a in range(3):
            for i in range(3):
                part = -weights[e, a, i]
                for j in range(3):
                    part += (bent[i, j] - L[i, j]) * weights[e, a, j]
                divergence[cells[e, a + 1], i] += part
                divergence[corner, i] -= part


@njit(cache=True, inline="always")
def _exponential(M, E, scratch):  # type: ignore[no-untyped-def]
    """Raise e to M, which is scaled on the way, by scaling and squaring."""
    for i in range(3):
        for j in range(3):
            M[i, j] *= 0.5**HALVINGS
            E[i, j] = M[i, j] / 3 + (1.0 if i == j else 0.0)
    for order in (2.0, 1.0):
        _multiply(M, E, scratch)
        for i in range(3):
            for j in range(3):
                E[i, j] = scratch[i, j] / order + (1.0 if i == j else 0.0)
    for _ in range(HALVINGS // 2):
        _multiply(E, E, scratch)
        _multiply(scratch, scratch, E)


@njit(cache=True, inline="always")
def _multiply(A, B, AB):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(3):
            AB[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]
