"""A random forest for all nodes (Lorente et al. 2017)."""

from physgnn.learning.classical.estimators.random_trees import FOREST, RandomTrees
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class RandomForest(NodalLearner):
    """Trees of rows drawn anew, from a node and the load to its displacement.

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
            lambda seed: RandomTrees(
                trees, smallest_leaf=smallest_leaf, seed=seed, grown=FOREST
            ),
        )
