"""Right-hand sides solved together, each with the bits it would have in other company.

BLAS takes other ways for other numbers of columns, so the last bits of a solution
depend on how many right-hand sides it was solved with; a run that is killed and resumed
would not repeat itself. So their number is always ``WIDTH``, filled up with zeros. With
MKL, whose results do not depend on where in memory an array lies (see
`physgnn.mechanics.linear.mkl`), the same column has the same bits in every place.
"""

from collections.abc import Sequence

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.linear.protocols import Factor

# On 27,000 unknowns one takes 7.0 ms, 4 take 12.4, 8 take 18; but a whole load path
# takes as long in 8, and where a run is killed twice as many paths are lost.
WIDTH = 4


def solve_each(factor: Factor, rights: Sequence[FloatArray]) -> list[FloatArray]:
    """Return K⁻¹ b for every b, (n,); the bits of one don't depend on the others."""
    solved: list[FloatArray] = []
    while len(solved) < len(rights):
        some = rights[len(solved) : len(solved) + WIDTH]
        filled = np.zeros((WIDTH, len(some[0])))
        filled[: len(some)] = some
        solved.extend(factor.solve(filled)[: len(some)])
    return solved
