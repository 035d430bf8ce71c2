"""Extremely random trees per node (Lorente et al. 2017)."""

from physgnn.learning.classical.estimators.random_trees import RandomTrees
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class ExtraTrees(NodalLearner):
    """Randomised trees from a node and the load to the node's displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    trees : int
        How many.
    smallest_leaf : int
        Rows in a leaf, at least.
    """

    def __init__(self, body: Body, *, trees: int = 20, smallest_leaf: int = 5) -> None:
        super().__init__(
            body,
            lambda seed: RandomTrees(trees, smallest_leaf=smallest_leaf, seed=seed),
        )
