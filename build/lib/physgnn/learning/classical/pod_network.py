"""A small network from the load to the weights of POD modes (Liu et al. 2020)."""

from physgnn.learning.classical.estimators.scaled_network import ScaledNetwork
from physgnn.learning.classical.learners.pod_learner import PODLearner
from physgnn.mechanics.body import Body


class PODNetwork(PODLearner):
    """A multilayer perceptron from the load to the weights of POD modes.

    Parameters
    ----------
    body : Body
        What is loaded.
    pod_modes : int
        How many; fewer if there are fewer samples.
    width, layers : int
        Of the network's hidden part.
    epochs : int
        Passes over the samples.
    """

    def __init__(
        self,
        body: Body,
        *,
        pod_modes: int = 128,
        width: int = 128,
        layers: int = 2,
        epochs: int = 200,
    ) -> None:
        hidden = (width,) * layers
        super().__init__(
            body,
            lambda seed: ScaledNetwork(hidden, epochs=epochs, seed=seed),
            pod_modes=pod_modes,
        )
