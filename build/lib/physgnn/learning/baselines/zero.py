"""No displacement: what a prediction must beat to say anything."""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.loads.paths import LoadCase


class Zero(Surrogate):
    """Predicts that nothing moves."""

    learns = False
    zero_without_load = True

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return zeros, (n_points, 3)."""
        del load_case
        return np.zeros_like(self.body.mesh.points)
