"""Least squares with a small penalty, scikit-learn's, for rows of float32."""

import numpy as np
from numpy.typing import NDArray
from sklearn.linear_model import Ridge

from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.classical.estimators.scaling import Scaling
from physgnn.learning.surrogate import Arrays


class LinearRows:
    """A linear map of standardised inputs.

    Parameters
    ----------
    penalty : float
        On the squared coefficients of the scaled inputs, over the number of rows: keeps
        columns apart that say the same.
    """

    def __init__(self, penalty: float) -> None:
        self._penalty = penalty

    def fit(self, inputs: Rows, targets: Rows) -> "LinearRows":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        self._scaling = Scaling.of(inputs, targets)
        ridge = Ridge(alpha=self._penalty * len(inputs), fit_intercept=False)
        scaled = self._scaling.inputs(inputs).astype(np.float64)
        ridge.fit(scaled, self._scaling.targets(targets))
        self._map = np.atleast_2d(ridge.coef_).T.astype(np.float32)
        return self

    def predict(self, inputs: Rows) -> NDArray[np.floating]:
        """Return (n, n_targets)."""
        return self._scaling.back(self._scaling.inputs(inputs) @ self._map)

    def arrays(self) -> Arrays:
        """Return scales and coefficients."""
        return {**self._scaling.arrays(), "map": self._map}

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        self._scaling, self._map = Scaling.restored(arrays), arrays["map"]
