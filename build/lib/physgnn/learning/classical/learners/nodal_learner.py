"""Displacement node by node: one learner, told the node and the load."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.learners.load_features import LoadFeatures, Rows
from physgnn.learning.classical.learners.row_learner import RowLearner
from physgnn.mechanics.loads.paths import LoadCase

N_ROWS = 500_000  # (sample, node) pairs to learn from, to bound memory


class NodalLearner(RowLearner):
    """A row a node: its place and the load in, its displacement in mm out.

    As Lorente et al. 2017 use trees and Tonutti et al. 2017 a small network.
    """

    def learn(self, store: Store, samples: IntArray, seed: int) -> None:
        """Fit the estimator to as many nodes of every sample, drawn by the seed."""
        self.estimator.fit(*_rows(self.features, store, samples, seed))

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return what the estimator says of every free node, (n_points, 3), mm."""
        n_points = self.body.mesh.n_points
        free = np.setdiff1d(np.arange(n_points), self.body.fixed)
        displacement = np.zeros((n_points, 3))
        rows = _features(self.features, load_case, free)
        displacement[free] = self.estimator.predict(rows)
        return displacement


def _rows(
    features: LoadFeatures, store: Store, samples: IntArray, seed: int
) -> tuple[Rows, Rows]:
    """Draw as many nodes of every sample; one read a path."""
    rng = np.random.default_rng(seed)
    free = np.setdiff1d(np.arange(store.mesh.n_points), store.fixed)
    n_nodes = min(max(N_ROWS // len(samples), 1), len(free))
    order = samples[np.lexsort((samples[:, 1], samples[:, 0]))]
    inputs, targets = [], []
    for path, level in order.tolist():
        nodes = rng.choice(free, n_nodes, replace=False)
        inputs.append(_features(features, store.load_case(path, level), nodes))
        targets.append(store.displacement(path)[level][nodes])
    return np.concatenate(inputs), np.concatenate(targets)


def _features(features: LoadFeatures, case: LoadCase, nodes: IntArray) -> Rows:
    of_nodes, of_case = features.of_nodes(case, nodes), features.of_case(case)
    return np.hstack([of_nodes, np.broadcast_to(of_case, (len(nodes), len(of_case)))])
