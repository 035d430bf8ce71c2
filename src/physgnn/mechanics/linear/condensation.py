"""K⁻¹ up to date in a part of a body, and as it was in the rest.

With the unknowns of the part, L, before the others, O, block elimination reads

    y = K_LL⁻¹ b_L,   u_O = S⁻¹ (b_O − K_OL y),   u_L = y − K_LL⁻¹ K_LO u_O

with S = K_OO − K_OL K_LL⁻¹ K_LO, the static condensation of K on O (Guyan 1965, *AIAA
Journal* 3, 380). S⁻¹ is the block O, O of K⁻¹, so that the factor of an earlier K
solves with the earlier S. Here it does, and K_LL and K_LO are those of now. What comes
of it is symmetric and positive definite, and balances all forces on L.

Where pressures are unknowns too, those of all groups with a point of L belong to L.
Then none of the others is coupled to it.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.protocols import Factor


@dataclass(frozen=True, eq=False)
class _Triangle:
    """The pattern of the upper triangle of K_LL, as a direct solver takes it."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    n_unknowns: int


class Condensation:
    """Solves with a tangent of which only a part is up to date.

    Parameters
    ----------
    pattern : Pattern
        Of the whole tangent.
    points : integer array
        The part: some of the pattern's free points, at least one.
    whole : Factor
        Holds the factor of an earlier tangent of that pattern.
    threads : int
        For factorisations and back-solves of the part.
    """

    def __init__(
        self,
        pattern: Pattern,
        points: IntArray,
        whole: Factor,
        *,
        threads: int = 1,
    ) -> None:
        self._whole = whole
        row = np.repeat(np.arange(len(pattern.indptr) - 1), np.diff(pattern.indptr))
        column = pattern.indices
        inside = _rows_of(pattern, points, row)
        self._n_rows = len(inside)
        self._inside = np.flatnonzero(inside)
        self._moving = self._inside[: 3 * len(points)]  # pressures come after them
        self._own = np.flatnonzero(inside[row] & inside[column])
        place = np.cumsum(inside) - 1
        indptr = np.concatenate([[0], np.cumsum(np.bincount(place[row[self._own]]))])
        triangle = _Triangle(
            indptr.astype(np.int32),
            place[column[self._own]].astype(np.int32),
            len(self._moving),
        )
        self._linear = make_linear_solver(triangle, precision="single", threads=threads)
        across = np.flatnonzero(inside[row] != inside[column])
        first = inside[row[across]]
        own = place[np.where(first, row[across], column[across])]
        other = np.where(first, column[across], row[across])
        self._beside, other = np.unique(other, return_inverse=True)
        shape = (len(self._inside), len(self._beside))
        rank = sp.csr_matrix((np.arange(len(across)), (own, other)), shape=shape)
        self._across = across[rank.data]
        self._coupling = sp.csr_matrix(rank, dtype=np.float64)

    def factorize(self, data: FloatArray) -> bool:
        """Factorise K_LL; False if it, and so K, is not positive definite.

        Parameters
        ----------
        data : (nnz,) array
            Values of the whole pattern, N/mm, up to date in all rows and columns of
            the part.
        """
        self._coupling.data = data[self._across]
        return self._linear.factorize(data[self._own])

    def solve(self, right: FloatArray) -> FloatArray:
        """Return what comes of b, (n_unknowns,)."""
        condensed = np.zeros(self._n_rows)
        condensed[: len(right)] = right
        inner = self._linear.solve(condensed[self._inside])
        condensed[self._inside] = 0.0
        condensed[self._beside] -= self._coupling.T @ inner
        x = self._whole.solve(condensed[: len(right)])
        inner -= self._linear.solve(self._coupling @ x[self._beside])
        x[self._moving] = inner[: len(self._moving)]
        return x


def _rows_of(pattern: Pattern, points: IntArray, row: IntArray) -> BoolArray:
    """Return which rows are of the points' unknowns and pressures.

    `row` is that of every entry.
    """
    inside = np.zeros(len(pattern.indptr) - 1, dtype=np.bool_)
    inside[: pattern.n_unknowns].reshape(-1, 3)[pattern.row[points]] = True
    of_pressure = pattern.indices >= pattern.n_unknowns
    inside[pattern.indices[inside[row] & of_pressure]] = True
    return inside
