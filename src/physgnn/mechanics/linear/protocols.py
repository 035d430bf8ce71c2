"""What a solver of K x = b offers, and what it needs of a matrix's pattern."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray


class UpperTriangle(Protocol):
    """The pattern of the upper triangle of a symmetric matrix, diagonal included.

    Rows after those of the unknowns are of pressures, which follow from these: the
    right-hand side is zero there, and the diagonal not
    (`physgnn.mechanics.elements.averaged_pressure`).
    """

    @property
    def indptr(self) -> NDArray[np.int32]:
        """Where rows begin among the entries."""

    @property
    def indices(self) -> NDArray[np.int32]:
        """Columns of the entries."""

    @property
    def n_unknowns(self) -> int:
        """Number of rows that are not of pressures."""


class Factor(Protocol):
    """Solves with a matrix that was factorised."""

    def solve(self, right: FloatArray) -> FloatArray:
        """Return K⁻¹ b for b of shape (n,) or (n_right, n).

        Here n is the number of unknowns, or of all rows: pressures that b does not
        have, the answer does not have either.
        """


class LinearSolver(Factor, Protocol):
    """Factorise often, solve more often, analyse once."""

    def factorize(self, data: FloatArray) -> bool:
        """Factorise K from the pattern's values; False if not positive definite."""


class DirectSolver(LinearSolver, Protocol):
    """A linear solver that knows what its factor weighs."""

    @property
    def n_bytes(self) -> int:
        """What the factor takes in memory."""
