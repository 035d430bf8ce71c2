"""Radial basis functions from the load to the displacement (De et al. 2011)."""

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.classical.estimators.radial_rows import RadialRows
from physgnn.learning.classical.learners.pod_learner import PODLearner
from physgnn.mechanics.body import Body


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

    draws = False

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
            lambda _: RadialRows(kernel, smoothing=smoothing, most_rows=rows),
            pod_modes=pod_modes,
        )

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:  # noqa: ARG002
        """Find modes and interpolate; no seed changes anything."""
        super().fit(store, samples, 0)
