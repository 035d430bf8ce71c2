"""Support vector regression for all nodes (Tonutti et al. 2017)."""

from functools import partial

from physgnn.learning.classical.estimators.kernel_rows import (
    KernelRows,
    support_vectors,
)
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class SupportVectors(NodalLearner):
    """A support vector machine a direction, from a node and the load.

    Parameters
    ----------
    body : Body
        What is loaded.
    rows : int
        Learnt from, at most: the time grows with their square.
    cost, tube : float
        Of an error beyond the tube; half the tube's width, in standard deviations.
    """

    def __init__(
        self, body: Body, *, rows: int = 4000, cost: float = 10.0, tube: float = 0.02
    ) -> None:
        weigh = partial(support_vectors, cost=cost, tube=tube)
        super().__init__(
            body, lambda seed: KernelRows(weigh, most_rows=rows, seed=seed)
        )
