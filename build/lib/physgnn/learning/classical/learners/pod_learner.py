"""Displacement as a sum of POD modes, their weights learnt from the load."""

from collections.abc import Callable

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.estimators.estimator import Estimator
from physgnn.learning.classical.learners.load_features import LoadFeatures, Rows
from physgnn.learning.classical.learners.row_learner import RowLearner
from physgnn.learning.surrogate import Arrays
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.pod_galerkin.pod import leading_modes

N_SNAPSHOTS = 512  # fields the modes are made of, to bound memory


class PODLearner(RowLearner):
    """A row a sample: the load in, the weights of the modes out.

    The idea of Liu et al. 2020: proper orthogonal decomposition of the training
    displacements, and a small network from the load to the weights of the modes.

    Parameters
    ----------
    body : Body
        What is loaded.
    estimator : callable
        From a seed to an estimator of weights.
    pod_modes : int
        How many; fewer if there are fewer samples.
    """

    def __init__(
        self, body: Body, estimator: Callable[[int], Estimator], *, pod_modes: int = 128
    ) -> None:
        super().__init__(body, estimator)
        self._n_modes = pod_modes
        self._modes = np.zeros((0, body.mesh.points.size), dtype=np.float32)

    def learn(self, store: Store, samples: IntArray, seed: int) -> None:
        """Find the modes of snapshots that the seed draws; fit the estimator."""
        rng = np.random.default_rng(seed)
        chosen = rng.permutation(len(samples))[:N_SNAPSHOTS]
        snapshots = [store.displacement(path)[level] for path, level in samples[chosen]]
        modes = leading_modes(np.stack(snapshots), min(self._n_modes, len(chosen)))
        modes[:, self.body.fixed] = 0.0  # as in every snapshot, but for rounding
        self._modes = modes.reshape(len(modes), -1).astype(np.float32)
        self.estimator.fit(*_rows(self.features, self._modes, store, samples))

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the sum of the modes, (n_points, 3), mm."""
        found = self.estimator.predict(self.features.of_case(load_case)[None])
        field: FloatArray = (found @ self._modes).reshape(-1, 3).astype(np.float64)
        return field

    def arrays(self) -> Arrays:
        """Return the modes beside what every learner of rows keeps."""
        return {**super().arrays(), "modes": self._modes}

    def restore(self, arrays: Arrays) -> None:
        """Take the modes and what the estimator learnt."""
        super().restore(arrays)
        self._modes = arrays["modes"]


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
