"""Regression trees of three kinds, scikit-learn's, kept as arrays."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesRegressor, RandomForestRegressor

from physgnn.arrays import FloatArray
from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.surrogate import Arrays

LEAF = -1

EXTRA, FOREST, SINGLE = "extra", "forest", "single"

GROWN: Mapping[str, Callable[..., Any]] = {
    EXTRA: partial(ExtraTreesRegressor, max_features=1 / 3),
    FOREST: partial(RandomForestRegressor, max_features=1 / 3),
    SINGLE: partial(RandomForestRegressor, bootstrap=False, max_features=None),
}
"""How trees are grown: splits drawn at random (Geurts et al. 2006); the best splits on
rows drawn with replacement (Breiman 2001); the best splits on all rows. The first two
look at a third of the inputs at a split, as is usual for regression."""


class RandomTrees:
    """Trees whose mean is the prediction, grown in one thread.

    Parameters
    ----------
    n_trees : int
        How many.
    smallest_leaf : int
        Rows in a leaf, at least.
    seed : int
        Of the splits.
    grown : str
        A row of ``GROWN``.
    """

    def __init__(
        self, n_trees: int, *, smallest_leaf: int, seed: int, grown: str = EXTRA
    ) -> None:
        self._n_trees, self._smallest_leaf = n_trees, smallest_leaf
        self._seed, self._grown = seed, grown
        self._arrays: dict[str, NDArray[Any]] = {}

    def fit(self, inputs: Rows, targets: Rows) -> "RandomTrees":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        forest = GROWN[self._grown](
            n_estimators=self._n_trees,
            min_samples_leaf=self._smallest_leaf,
            random_state=self._seed,
            n_jobs=1,
        )
        forest.fit(inputs, targets)
        self._arrays = _as_arrays([each.tree_ for each in forest.estimators_])
        return self

    def predict(self, inputs: Rows) -> FloatArray:
        """Return (n, n_targets)."""
        tree = self._arrays
        found: FloatArray = _mean_of_leaves(
            np.ascontiguousarray(inputs, dtype=np.float32),
            tree["root"], tree["child"], tree["feature"], tree["threshold"],
            tree["value"],
        )  # fmt: skip
        return found

    def arrays(self) -> Arrays:
        """Return the nodes of all trees, one after another, and the leaves' values."""
        return self._arrays

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        self._arrays = dict(arrays)


def _as_arrays(trees: list[Any]) -> dict[str, NDArray[Any]]:
    """Return trees of scikit-learn as arrays over all their nodes.

    Returns
    -------
    dict
        ``root``, the first node of each tree; ``child``, (n_nodes, 2), where a row goes
        that is at most the threshold, and where else; ``feature``, `LEAF` at leaves,
        whose first child is a row of ``value``; ``threshold`` in float32.
    """
    n_nodes = [tree.node_count for tree in trees]
    root = np.cumsum([0, *n_nodes[:-1]])
    child = np.concatenate(
        [
            np.column_stack([tree.children_left, tree.children_right]) + first
            for tree, first in zip(trees, root, strict=True)
        ]
    )
    leaf = np.concatenate([tree.children_left < 0 for tree in trees])
    feature = np.concatenate([tree.feature for tree in trees])
    value = np.concatenate([tree.value[..., 0] for tree in trees])
    feature[leaf], child[leaf, 0] = LEAF, np.arange(leaf.sum())
    return {
        "root": root.astype(np.int32),
        "child": child.astype(np.int32),
        "feature": feature.astype(np.int16),
        "threshold": _at_most(np.concatenate([tree.threshold for tree in trees])),
        "value": value[leaf].astype(np.float32),
    }


def _at_most(threshold: FloatArray) -> NDArray[np.float32]:
    """Return the largest float32 that is no larger: float32 rows fall the same way."""
    rounded = threshold.astype(np.float32)
    below = np.nextafter(rounded, np.float32(-np.inf))
    return np.where(rounded > threshold, below, rounded)


@njit(cache=True)
def _mean_of_leaves(inputs, root, child, feature, threshold, value):  # type: ignore[no-untyped-def]
    """Return the mean over trees of the leaf each row falls into."""
    found = np.zeros((len(inputs), value.shape[1]))
    for row in range(len(inputs)):
        for node in root:
            while feature[node] >= 0:
                right = inputs[row, feature[node]] > threshold[node]
                node = child[node, 1 if right else 0]
            for target in range(value.shape[1]):
                found[row, target] += value[child[node, 0], target]
    return found / len(root)
