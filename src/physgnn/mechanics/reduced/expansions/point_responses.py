"""K⁻¹ f for loads on a few points: a product where a back-solve takes ten times longer.

A back-solve reads the whole factor twice; the columns of K⁻¹ that belong to a hundred
loaded points are less than half of that, and read once.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.tangent import Pattern
from physgnn.mechanics.linear.protocols import DirectSolver

MAX_BYTES = 96 * 2**20  # of columns; about what the factor takes for 9000 points
AT_ONCE = 48  # right-hand sides of a back-solve


class PointResponses:
    """Linear responses to any load, fastest where it acts on chosen points only.

    Parameters
    ----------
    solver : DirectSolver
        Holds the factor of K.
    pattern : Pattern
        The pattern of K, over the free points.
    nodes : (n_nodes,) integer array
        Points that loads act on, as a rule. Their columns are made, in single
        precision and some at once, when a load first acts on them; if all would take
        too much memory, every response is a back-solve.
    """

    def __init__(self, solver: DirectSolver, pattern: Pattern, nodes: IntArray) -> None:
        self._solver, self._pattern = solver, pattern
        nodes = np.intersect1d(nodes, pattern.free)
        n_bytes = 4 * 3 * len(nodes) * 3 * len(pattern.row)
        self._nodes = nodes if n_bytes <= MAX_BYTES else nodes[:0]
        self._unknowns = _three_of_each(pattern.row[self._nodes])
        size = len(self._unknowns), 3 * len(pattern.row)
        self._columns = np.zeros(size, dtype=np.float32)
        self._made = np.zeros(-(-len(self._unknowns) // AT_ONCE), dtype=np.bool_)

    def __call__(self, force: FloatArray) -> FloatArray:
        """Return K⁻¹ f, (n_points, 3) mm, for a force field (n_points, 3) in N."""
        on_nodes = force[self._nodes].astype(np.float32).ravel()
        for block in np.unique(np.flatnonzero(on_nodes) // AT_ONCE):
            if not self._made[block]:
                self._make(block)
        moved = np.zeros(self._columns.shape[1], dtype=np.float32)
        _add_rows(on_nodes, self._columns, moved)
        u = moved.reshape(force.shape).astype(np.float64)
        if np.count_nonzero(force) > np.count_nonzero(on_nodes):
            rest = force.copy()
            rest[self._nodes] = 0.0
            u += self.solve(rest)
        return u

    def solve(self, force: FloatArray) -> FloatArray:
        """Return K⁻¹ f by a back-solve, for a load anywhere or several at once."""
        right = self._pattern.unknowns(force)
        return self._pattern.on_points(self._solver.solve(right))

    @property
    def n_bytes(self) -> int:
        """Memory of the factor and the columns."""
        return self._solver.n_bytes + self._columns.nbytes

    def _make(self, block: int) -> None:
        """Cache a block of the columns of K⁻¹, as rows."""
        own = slice(AT_ONCE * block, AT_ONCE * (block + 1))
        some = self._unknowns[own]
        right = np.zeros((len(some), self._pattern.n_unknowns))
        right[np.arange(len(some)), some] = 1.0
        response = self._pattern.on_points(self._solver.solve(right))
        self._columns[own] = response.reshape(len(some), -1)
        self._made[block] = True


def _three_of_each(rows: NDArray[np.int32]) -> IntArray:
    return (3 * rows.astype(np.int64)[:, None] + np.arange(3)).ravel()


@njit(cache=True)
def _add_rows(factors, rows, total):  # type: ignore[no-untyped-def]
    """Add Σ_k factors[k] rows[k] to a total, four rows at a time; zeros are left out.

    Not by BLAS: OpenBLAS's threads and those of Pardiso and torch get in each other's
    way, as each spin for a while when they are done.
    """
    whole = len(factors) // 4 * 4
    for k in range(0, whole, 4):
        a, b, c, d = factors[k], factors[k + 1], factors[k + 2], factors[k + 3]
        if a == b == c == d == 0.0:
            continue
        for j in range(len(total)):
            total[j] += (
                a * rows[k, j] + b * rows[k + 1, j] + c * rows[k + 2, j]
            ) + d * rows[k + 3, j]
    for k in range(whole, len(factors)):
        for j in range(len(total)):
            total[j] += factors[k] * rows[k, j]
