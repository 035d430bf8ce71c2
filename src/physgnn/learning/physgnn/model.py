"""PhysGNN as a model: published features, a normaliser, the network."""

import numpy as np
from torch import Tensor

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.graph import Graph, as_float32
from physgnn.learning.network import Network
from physgnn.learning.physgnn.architecture import PUBLISHED_DEPTH, Architecture
from physgnn.learning.physgnn.features import load_features, physical_property
from physgnn.learning.physgnn.layers.jumping_knowledge import JumpingKnowledge
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.physgnn.normalization import Normalizer
from physgnn.learning.physgnn.precision import set_precision
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase

NORMALISERS = ("training", "published")


class PhysGNNModel(Network):
    """The published network between a load case and its displacement.

    Parameters
    ----------
    body : Body
        What it's made for.
    configuration, dataset : int
        See :class:`physgnn.learning.physgnn.architecture.Architecture`.
    width : int
        Columns between layers, even.
    normaliser : {"training", "published"}
        Fit mean and deviation to the training samples only, or, as was published, to
        the whole dataset, held-out samples included.
    depth, jumping_knowledge
        What was left out of the published network: see `Architecture`.
    """

    def __init__(
        self,
        body: Body,
        *,
        configuration: int = 3,
        dataset: int = 2,
        width: int = 112,
        normaliser: str = "training",
        depth: int = PUBLISHED_DEPTH,
        jumping_knowledge: bool = True,
    ) -> None:
        super().__init__(body)
        if normaliser not in NORMALISERS:
            raise InputError(
                f"normaliser must be one of {', '.join(NORMALISERS)} (got {normaliser})"
            )
        self.fits_on_everything = normaliser == "published"
        self.property = physical_property(body.mesh, body.fixed)
        self.normalizer = Normalizer()
        architecture = Architecture(configuration, dataset, depth, jumping_knowledge)
        self.network = PhysGNN(architecture, width)

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Fit the normaliser."""
        del seed
        everything = self.fits_on_everything
        self.normalizer.fit(store, store.samples() if everything else samples)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return standardised features, (n_points, 7) float32."""
        columns = load_features(load_case, self.body.mesh.n_points)
        scaled = self.normalizer.standardise(columns)
        return as_float32(np.column_stack([self.property, scaled]))

    def spare_memory(self, spare: bool) -> None:
        """Compute what the LSTMs would keep for the backward pass twice, or keep it."""
        for module in self.network.modules():
            if isinstance(module, JumpingKnowledge):
                module.compiled.keep_states = not spare

    def set_precision(self, precision: str) -> None:
        """Choose the precision of the LSTMs' products."""
        set_precision(self, precision)

    def begin_with(self, other: Surrogate) -> None:
        """Begin with a copy of weights that were trained on another mesh.

        What they know of the far field is of that mesh, and has to be learnt anew.
        """
        if not isinstance(other, PhysGNNModel):
            raise InputError("a PhysGNN can only begin with the weights of a PhysGNN")
        mine, theirs = self.network, other.network
        if (mine.architecture, mine.width) != (theirs.architecture, theirs.width):
            raise InputError(
                "its options must be those of the run to begin with, "
                f"{theirs.architecture}, width {theirs.width} (got "
                f"{mine.architecture}, width {mine.width})"
            )
        self.network.load_state_dict(theirs.state_dict())

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3)."""
        displacement: Tensor = self.network(inputs, graph)
        return displacement

    def at_points(self, inputs: Tensor, graph: Graph, points: Tensor) -> Tensor:
        """Return displacement at some points in mm, (batch, n, 3)."""
        displacement: Tensor = self.network(inputs, graph, points)
        return displacement
