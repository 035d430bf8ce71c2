"""Displacement node by node: one learner, told the node and the load."""

import numpy as np

from physgnn.dataset.store import Store
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.classical.estimator import Estimator
from physgnn.prediction.classical.load_features import IntArray, LoadFeatures, Rows
from physgnn.prediction.prediction import Answer, FloatArray

N_ROWS = 500_000  # (sample, node) pairs to learn from, to bound memory


def nodal_answer(
    estimator: Estimator, store: Store, samples: IntArray, *, seed: int
) -> Answer:
    """Return a learner of single nodes, fitted, as a function of the load case.

    As Lorente et al. 2017 use trees and Tonutti et al. 2017 a small network: a row a
    node, its place and the load in, its displacement out.

    Parameters
    ----------
    estimator : Estimator
        From features to displacement, mm.
    store : Store
    samples : (n, 2) integer array
        Rows of (path, level) to learn from.
    seed : int
        Of the choice of nodes.
    """
    features = LoadFeatures.of(store, samples)
    estimator.fit(*_rows(features, store, samples, seed))
    free = np.setdiff1d(np.arange(store.mesh.n_points), store.fixed)

    def answer(case: LoadCase) -> FloatArray:
        displacement = np.zeros((store.mesh.n_points, 3))
        displacement[free] = estimator.predict(_features(features, case, free))
        return displacement

    return answer


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
