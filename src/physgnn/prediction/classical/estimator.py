"""What a learner must offer, and the scikit-learn ones made to work in float32."""

import warnings
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor

Rows = NDArray[np.float32]


class Estimator(Protocol):
    """A learner of rows, as scikit-learn's."""

    def fit(self, inputs: Rows, targets: Rows) -> Any:
        """Learn from (n, n_inputs) and (n, n_targets)."""
        ...

    def predict(self, inputs: Rows) -> Rows:
        """Return (n, n_targets)."""
        ...


class ScaledNetwork:
    """A small multilayer perceptron on standardised inputs, for a number of epochs.

    Targets are counted from their mean, all in one unit, so that the squared error
    keeps its meaning.

    Parameters
    ----------
    hidden : tuple of int
        Widths of the hidden layers.
    epochs : int
        Passes over the rows.
    seed : int
        Of weights and order.
    """

    def __init__(self, hidden: tuple[int, ...], *, epochs: int, seed: int) -> None:
        self._network = MLPRegressor(
            hidden_layer_sizes=hidden,
            max_iter=epochs,
            n_iter_no_change=epochs,
            random_state=seed,
        )

    def fit(self, inputs: Rows, targets: Rows) -> "ScaledNetwork":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        self._middle, width = inputs.mean(axis=0), inputs.std(axis=0)
        self._width = np.where(width > 0, width, 1.0).astype(np.float32)
        self._mean = targets.mean(axis=0)
        self._unit = np.float32((targets - self._mean).std() or 1.0)
        with warnings.catch_warnings():  # the epochs are a budget, not a failure
            warnings.simplefilter("ignore", ConvergenceWarning)
            self._network.fit(self._scaled(inputs), (targets - self._mean) / self._unit)
        return self

    def predict(self, inputs: Rows) -> Rows:
        """Return (n, n_targets)."""
        scaled = self._network.predict(self._scaled(inputs))
        found: Rows = scaled * self._unit + self._mean
        return found

    def _scaled(self, inputs: Rows) -> Rows:
        scaled: Rows = (inputs - self._middle) / self._width
        return scaled


def random_trees(n_trees: int, *, smallest_leaf: int, seed: int) -> Estimator:
    """Return extremely randomised trees (Geurts et al. 2006), one thread."""
    trees: Estimator = ExtraTreesRegressor(
        n_trees,
        min_samples_leaf=smallest_leaf,
        max_features=1 / 3,
        random_state=seed,
        n_jobs=1,
    )
    return trees
