"""A small multilayer perceptron, scikit-learn's, made to work in float32."""

import warnings

import numpy as np
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor

from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.classical.estimators.scaling import Scaling
from physgnn.learning.surrogate import Arrays


class ScaledNetwork:
    """A small multilayer perceptron on standardised inputs, for a number of epochs.

    Targets are counted from their mean, all in one unit, so that the squared error
    keeps its meaning. Hidden layers are rectified. What is kept are the weights alone.

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
        self._hidden, self._epochs, self._seed = hidden, epochs, seed
        self._layers: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []

    def fit(self, inputs: Rows, targets: Rows) -> "ScaledNetwork":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        self._scaling = Scaling.of(inputs, targets)
        network = MLPRegressor(
            hidden_layer_sizes=self._hidden,
            max_iter=self._epochs,
            n_iter_no_change=self._epochs,
            random_state=self._seed,
        )
        with warnings.catch_warnings():  # the epochs are a budget, not a failure
            warnings.simplefilter("ignore", ConvergenceWarning)
            network.fit(self._scaling.inputs(inputs), self._scaling.targets(targets))
        self._layers = list(zip(network.coefs_, network.intercepts_, strict=True))
        return self

    def predict(self, inputs: Rows) -> Rows:
        """Return (n, n_targets)."""
        found = self._scaling.inputs(inputs)
        for weights, bias in self._layers[:-1]:
            found = np.maximum(found @ weights + bias, 0.0)
        weights, bias = self._layers[-1]
        displaced: Rows = self._scaling.back(found @ weights + bias)
        return displaced

    def arrays(self) -> Arrays:
        """Return scales, weights and biases."""
        found = dict(self._scaling.arrays())
        for i, (weights, bias) in enumerate(self._layers):
            found |= {f"weights.{i}": weights, f"bias.{i}": bias}
        return found

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        self._scaling = Scaling.restored(arrays)
        self._layers = [
            (arrays[f"weights.{i}"], arrays[f"bias.{i}"])
            for i in range(len(self._hidden) + 1)
        ]
