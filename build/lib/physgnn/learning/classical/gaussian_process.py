"""Gaussian process regression for all nodes (Tonutti et al. 2017)."""

from physgnn.learning.classical.estimators.kernel_rows import (
    KernelRows,
    gaussian_process,
)
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class GaussianProcess(NodalLearner):
    """The mean of a Gaussian process, from a node and the load to its displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    rows : int
        Learnt from, at most: the time grows with their cube.
    """

    def __init__(self, body: Body, *, rows: int = 3000) -> None:
        super().__init__(
            body, lambda seed: KernelRows(gaussian_process, most_rows=rows, seed=seed)
        )
