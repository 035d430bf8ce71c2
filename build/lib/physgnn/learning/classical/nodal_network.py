"""A small network per node (Tonutti et al. 2017)."""

from physgnn.learning.classical.estimators.scaled_network import ScaledNetwork
from physgnn.learning.classical.learners.nodal_learner import NodalLearner
from physgnn.mechanics.body import Body


class NodalNetwork(NodalLearner):
    """A multilayer perceptron from a node and the load to the node's displacement.

    Parameters
    ----------
    body : Body
        What is loaded.
    width, layers : int
        Of the network's hidden part.
    epochs : int
        Passes over the rows.
    """

    def __init__(
        self, body: Body, *, width: int = 128, layers: int = 2, epochs: int = 20
    ) -> None:
        hidden = (width,) * layers
        super().__init__(
            body, lambda seed: ScaledNetwork(hidden, epochs=epochs, seed=seed)
        )
