"""K⁻¹ f for loads on a few points: a product where a back-solve takes ten times longer.

A back-solve reads the whole factor twice; the columns of K⁻¹ that belong to a hundred
loaded points are less than half of that, and read once.
"""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.learning.graph import as_float32
from physgnn.mechanics.assembly import Pattern
from physgnn.mechanics.linear_solver import LinearSolver

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_BYTES = 96 * 2**20  # of columns; about what the factor takes for 9000 points
AT_ONCE = 48  # right-hand sides of a back-solve


class PointResponses:
    """Answers any load; fastest where it acts on known points only.

    Parameters
    ----------
    solver : LinearSolver
        Holds the factor of K.
    pattern : Pattern
        Of K.
    nodes : (n_nodes,) integer array
        Points that loads act on, as a rule. If their columns, kept in single precision,
        would take too much memory, every answer is a back-solve.
    """

    def __init__(self, solver: LinearSolver, pattern: Pattern, nodes: IntArray) -> None:
        self._solver, self._free = solver, pattern.free
        self._n_points = len(pattern.row)
        nodes = np.intersect1d(nodes, pattern.free)
        n_bytes = 4 * 3 * len(nodes) * 3 * self._n_points
        self._nodes = nodes if n_bytes <= MAX_BYTES else nodes[:0]
        self._columns = self._kept(3 * pattern.row[self._nodes])

    def __call__(self, force: FloatArray) -> FloatArray:
        """Return K⁻¹ f, (n_points, 3) mm, for a force field (n_points, 3) in N."""
        known = as_float32(force[self._nodes]).ravel()
        u = (known @ self._columns).numpy().reshape(force.shape).astype(np.float64)
        if np.count_nonzero(force) > np.count_nonzero(known):
            rest = force.copy()
            rest[self._nodes] = 0.0
            u += self.solve(rest)
        return u

    def solve(self, force: FloatArray) -> FloatArray:
        """Return K⁻¹ f by a back-solve, for a load anywhere."""
        u = np.zeros_like(force)
        u[self._free] = self._solver.solve(force[self._free].ravel()).reshape(-1, 3)
        return u

    def _kept(self, unknowns: NDArray[np.int32]) -> Tensor:
        """Return the columns of K⁻¹ of points' three unknowns, as rows."""
        rows = (unknowns[:, None] + np.arange(3)).ravel()
        columns = np.zeros((len(rows), self._n_points, 3), dtype=np.float32)
        for first in range(0, len(rows), AT_ONCE):
            some = rows[first : first + AT_ONCE]
            right = np.zeros((len(some), 3 * len(self._free)))
            right[np.arange(len(some)), some] = 1.0
            answer = self._solver.solve(right).reshape(len(some), -1, 3)
            columns[first : first + AT_ONCE, self._free] = answer
        # A tensor: OpenBLAS's threads and those of Pardiso and torch get in each
        # other's way, as each spin for a while when they're done.
        return torch.from_numpy(columns.reshape(len(rows), 3 * self._n_points))
