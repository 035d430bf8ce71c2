"""Learners that weigh rows they have seen by their distance, scikit-learn's."""

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.distance import cdist
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel
from sklearn.svm import SVR

from physgnn.arrays import FloatArray
from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.classical.estimators.scaling import Scaling
from physgnn.learning.surrogate import Arrays

AT_ONCE = 4096  # rows whose distances are in memory together
FOR_LENGTH = 500  # rows from which a Gaussian process takes length and noise

Weighed = tuple[FloatArray, FloatArray, FloatArray, float]
"""Rows kept (m, n_inputs), weights (m, n_targets), constants (n_targets,), gamma."""


class KernelRows:
    """The sum over rows seen of weight · exp(−γ |x − row|²), plus a constant.

    Parameters
    ----------
    weigh : callable
        From scaled inputs, scaled targets and a random generator to the rows, their
        weights, the constants and γ.
    most_rows : int
        More are thinned out by the seed: the cost grows with their square or cube.
    seed : int
        Of what is drawn.
    """

    def __init__(
        self, weigh: Callable[..., Weighed], *, most_rows: int, seed: int
    ) -> None:
        self._weigh, self._most_rows, self._seed = weigh, most_rows, seed

    def fit(self, inputs: Rows, targets: Rows) -> "KernelRows":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        rng = np.random.default_rng(self._seed)
        self._scaling = Scaling.of(inputs, targets)
        chosen = np.sort(rng.permutation(len(inputs))[: self._most_rows])
        self._rows, self._weights, self._constant, self._gamma = self._weigh(
            self._scaling.inputs(inputs[chosen]).astype(np.float64),
            self._scaling.targets(targets[chosen]).astype(np.float64),
            rng,
        )
        return self

    def predict(self, inputs: Rows) -> NDArray[np.floating]:
        """Return (n, n_targets)."""
        scaled = self._scaling.inputs(inputs).astype(np.float64)
        parts = [
            self._kernel(scaled[i : i + AT_ONCE]) @ self._weights
            for i in range(0, len(scaled), AT_ONCE)
        ]
        return self._scaling.back(np.concatenate(parts) + self._constant)

    def _kernel(self, scaled: FloatArray) -> FloatArray:
        kernel: FloatArray = np.exp(
            -self._gamma * cdist(scaled, self._rows, "sqeuclidean")
        )
        return kernel

    def arrays(self) -> Arrays:
        """Return scales, rows, weights, constants and γ."""
        own = {"rows": self._rows, "weights": self._weights}
        own |= {"constant": self._constant, "gamma": np.array([self._gamma])}
        return {**self._scaling.arrays(), **own}

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        self._scaling = Scaling.restored(arrays)
        self._rows, self._weights = arrays["rows"], arrays["weights"]
        self._constant, self._gamma = arrays["constant"], float(arrays["gamma"][0])


def support_vectors(
    inputs: FloatArray,
    targets: FloatArray,
    rng: np.random.Generator,  # noqa: ARG001
    *,
    cost: float,
    tube: float,
) -> Weighed:
    """Return support vector regression (Drucker et al. 1997), a machine a target.

    Parameters
    ----------
    inputs, targets : (n, n_inputs), (n, n_targets) array
        Scaled.
    rng : Generator
        Not used: nothing is drawn.
    cost, tube : float
        Of an error beyond the tube; half the width of the tube that costs nothing.
    """
    gamma = 1.0 / inputs.shape[1]
    weights, constants = np.zeros_like(targets), np.zeros(targets.shape[1])
    for target, values in enumerate(targets.T):
        machine = SVR(kernel="rbf", C=cost, epsilon=tube, gamma=gamma)
        machine.fit(inputs, values)
        weights[machine.support_, target] = machine.dual_coef_[0]
        constants[target] = machine.intercept_[0]
    used = np.flatnonzero((weights != 0).any(axis=1))
    return inputs[used], weights[used], constants, gamma


def gaussian_process(
    inputs: FloatArray, targets: FloatArray, rng: np.random.Generator
) -> Weighed:
    """Return the mean of a Gaussian process (Rasmussen and Williams 2006, eq. 2.25).

    Length and noise have the largest marginal likelihood on some of the rows.

    Parameters
    ----------
    inputs, targets : (n, n_inputs), (n, n_targets) array
        Scaled.
    rng : Generator
        Draws the rows that length and noise are found on.
    """
    few = rng.permutation(len(inputs))[:FOR_LENGTH]
    process = GaussianProcessRegressor(
        RBF(np.sqrt(inputs.shape[1]), (1e-1, 1e3)) + WhiteKernel(1e-2, (1e-6, 1e1))
    )
    with warnings.catch_warnings():  # a bound on the noise is a choice, not a failure
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit(inputs[few], targets[few])
    found: Mapping[str, Any] = process.kernel_.get_params()
    length, noise = found["k1__length_scale"], found["k2__noise_level"]
    gamma = float(0.5 / length**2)
    kernel = np.exp(-gamma * cdist(inputs, inputs, "sqeuclidean"))
    kernel[np.diag_indices_from(kernel)] += noise
    weights: FloatArray = cho_solve(cho_factor(kernel, lower=True), targets)
    return inputs, weights, np.zeros(targets.shape[1]), gamma
