"""Displacement as a sum of modes, their weights learnt from the load."""

import numpy as np

from physgnn.dataset.store import Store
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.modes import leading_modes
from physgnn.prediction.classical.estimator import Estimator
from physgnn.prediction.classical.load_features import IntArray, LoadFeatures, Rows
from physgnn.prediction.prediction import Answer, FloatArray

N_MODES = 128
N_SNAPSHOTS = 512  # fields the modes are made of, to bound memory


def pod_answer(
    estimator: Estimator, store: Store, samples: IntArray, *, seed: int
) -> Answer:
    """Return a learner of POD weights, fitted, as a function of the load case.

    The idea of Liu et al. 2020: proper orthogonal decomposition of the training
    displacements, and a small network from the load to the weights of the modes.

    Parameters
    ----------
    estimator : Estimator
        From load features to weights.
    store : Store
    samples : (n, 2) integer array
        Rows of (path, level) to learn from.
    seed : int
        Of the choice of snapshots.
    """
    features = LoadFeatures.of(store, samples)
    rng = np.random.default_rng(seed)
    chosen = rng.permutation(len(samples))[:N_SNAPSHOTS]
    snapshots = [store.displacement(path)[level] for path, level in samples[chosen]]
    modes = leading_modes(np.stack(snapshots), min(N_MODES, len(chosen)))
    flat = modes.reshape(len(modes), -1).astype(np.float32)
    loads, weights = _rows(features, flat, store, samples)
    estimator.fit(loads, weights)

    def answer(case: LoadCase) -> FloatArray:
        found = estimator.predict(features.of_case(case)[None])
        field: FloatArray = (found @ flat).reshape(-1, 3).astype(np.float64)
        return field

    return answer


def _rows(
    features: LoadFeatures, flat: Rows, store: Store, samples: IntArray
) -> tuple[Rows, Rows]:
    """Return every sample's load features and POD weights; one read a path."""
    loads = [features.of_case(store.load_case(*sample)) for sample in samples]
    weights = np.empty((len(samples), len(flat)), dtype=np.float32)
    for path in np.unique(samples[:, 0]):
        of_path = samples[:, 0] == path
        fields = store.displacement(path)[samples[of_path, 1]]
        weights[of_path] = fields.reshape(len(fields), -1) @ flat.T
    return np.stack(loads), weights
