"""SciPy's interpolation by radial basis functions, for rows of float32."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator

from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.classical.estimators.scaling import Scaling
from physgnn.learning.surrogate import Arrays


class RadialRows:
    """SciPy's interpolation by radial basis functions, through rows seen.

    Parameters
    ----------
    kernel : str
        As SciPy names it.
    smoothing : float
        0 goes through every row; rows that are alike need a little.
    most_rows : int
        More are thinned out evenly: the time grows with their cube.
    """

    def __init__(self, kernel: str, *, smoothing: float, most_rows: int) -> None:
        self._kernel, self._smoothing = kernel, smoothing
        self._most_rows = most_rows

    def fit(self, inputs: Rows, targets: Rows) -> "RadialRows":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        n_rows = min(len(inputs), self._most_rows)
        chosen = np.linspace(0, len(inputs) - 1, n_rows).round().astype(int)
        self._take(Scaling.of(inputs, targets), inputs[chosen], targets[chosen])
        return self

    def _take(self, scaling: Scaling, inputs: Rows, targets: Rows) -> None:
        self._scaling, self._inputs, self._targets = scaling, inputs, targets
        self._through = RBFInterpolator(
            scaling.inputs(inputs).astype(np.float64),
            scaling.targets(targets).astype(np.float64),
            kernel=self._kernel,
            smoothing=self._smoothing,
            degree=0,
        )

    def predict(self, inputs: Rows) -> NDArray[np.floating]:
        """Return (n, n_targets)."""
        scaled = self._scaling.inputs(inputs).astype(np.float64)
        return self._scaling.back(self._through(scaled)).astype(np.float32)

    def arrays(self) -> Arrays:
        """Return scales and the rows gone through; `restore` solves for them again."""
        own = {"inputs": self._inputs, "targets": self._targets}
        return {**self._scaling.arrays(), **own}

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        self._take(Scaling.restored(arrays), arrays["inputs"], arrays["targets"])
