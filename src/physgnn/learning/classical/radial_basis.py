"""Radial basis functions from the load to the displacement (De et al. 2011)."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator

from physgnn.learning.classical.estimator import Rows
from physgnn.learning.classical.pod_learner import PODLearner
from physgnn.learning.classical.scaling import Scaling
from physgnn.learning.surrogate import Arrays
from physgnn.mechanics.body import Body


class RadialRows:
    """SciPy's interpolation by radial basis functions, through rows seen.

    Parameters
    ----------
    kernel : str
        As SciPy names it.
    smoothing : float
        0 goes through every row; rows that are alike need a little.
    most_rows : int
        More are thinned out by the seed: the time grows with their cube.
    seed : int
        Of what is drawn.
    """

    def __init__(
        self, kernel: str, *, smoothing: float, most_rows: int, seed: int
    ) -> None:
        self._kernel, self._smoothing = kernel, smoothing
        self._most_rows, self._seed = most_rows, seed

    def fit(self, inputs: Rows, targets: Rows) -> "RadialRows":
        """Learn from (n, n_inputs) and (n, n_targets)."""
        order = np.random.default_rng(self._seed).permutation(len(inputs))
        chosen = np.sort(order[: self._most_rows])
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


class RadialBasis(PODLearner):
    """A field interpolated between the fields of training loads like the one given.

    As De et al. 2011 (PhyNNeSS) go from loads to fields by radial basis functions. Here
    the fields are written in POD modes, which changes no field they span.

    Parameters
    ----------
    body : Body
        What is loaded.
    pod_modes : int
        How many; fewer if there are fewer samples.
    kernel : str
        As SciPy names it; one that is conditionally positive definite of order 1 at
        most.
    smoothing : float
        In units of the kernel.
    rows : int
        Training loads interpolated, at most.
    """

    def __init__(
        self,
        body: Body,
        *,
        pod_modes: int = 256,
        kernel: str = "linear",
        smoothing: float = 1e-6,
        rows: int = 3000,
    ) -> None:
        super().__init__(
            body,
            lambda seed: RadialRows(
                kernel, smoothing=smoothing, most_rows=rows, seed=seed
            ),
            pod_modes=pod_modes,
        )
