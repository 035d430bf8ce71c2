"""Regression trees for all nodes: one, a forest, extremely random ones.

From a node and the load to the node's displacement (Lorente et al. 2017).
"""

from physgnn.learning.classical.estimators.random_trees import (
    EXTRA,
    FOREST,
    SINGLE,
    RandomTrees,
)
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class RandomForest(NodalLearner):
    """Trees of rows drawn anew, the best splits of each.

    Parameters
    ----------
    body : Body
        What is loaded.
    trees : int
        How many.
    smallest_leaf : int
        Rows in a leaf, at least.
    """

    grown = FOREST

    def __init__(self, body: Body, *, trees: int = 20, smallest_leaf: int = 5) -> None:
        super().__init__(
            body,
            lambda seed: RandomTrees(
                trees, smallest_leaf=smallest_leaf, seed=seed, grown=self.grown
            ),
        )


class ExtraTrees(RandomForest):
    """Trees of all rows, split at random; parameters as of `RandomForest`."""

    grown = EXTRA


class DecisionTree(RandomForest):
    """One tree of all rows, the best splits.

    Parameters
    ----------
    body : Body
        What is loaded.
    smallest_leaf : int
        Rows in a leaf, at least.
    """

    grown = SINGLE

    def __init__(self, body: Body, *, smallest_leaf: int = 5) -> None:
        super().__init__(body, trees=1, smallest_leaf=smallest_leaf)
