"""One regression tree for all nodes (Lorente et al. 2017)."""

from physgnn.learning.classical.estimators.random_trees import SINGLE, RandomTrees
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class DecisionTree(NodalLearner):
    """A tree from a node and the load to the node's displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    smallest_leaf : int
        Rows in a leaf, at least.
    """

    def __init__(self, body: Body, *, smallest_leaf: int = 5) -> None:
        super().__init__(
            body,
            lambda seed: RandomTrees(
                1, smallest_leaf=smallest_leaf, seed=seed, grown=SINGLE
            ),
        )
