"""Transolver between a load case and its displacement."""

import torch
from torch import Tensor

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.graph import Graph, as_float32
from physgnn.learning.mesh_networks.node_inputs import N_INPUTS, NodeInputs
from physgnn.learning.mesh_networks.transolver import Transolver
from physgnn.learning.network import Network
from physgnn.learning.shared_weights import part_of_another
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase


class TransolverModel(Network):
    """Points have their kind, force and place; no edge of the mesh is used.

    Parameters
    ----------
    body : Body
        What is loaded.
    width, layers, heads, slices : int
        Of a point's state; blocks; heads and slices of the attention. Wu et al. 2024
        have 8 layers, 8 heads, and 32 or 64 slices.

    Raises
    ------
    InputError
        If the heads do not divide the width.
    """

    places: Tensor

    def __init__(
        self,
        body: Body,
        *,
        width: int = 128,
        layers: int = 8,
        heads: int = 8,
        slices: int = 32,
    ) -> None:
        super().__init__(body)
        if width % heads:
            raise InputError(f"heads must divide width {width} (got {heads})")
        from_centre = body.mesh.points - body.mesh.points.mean(axis=0)
        places = as_float32(from_centre / from_centre.std())
        self.register_buffer("places", places, persistent=False)
        self.inputs = NodeInputs(body)
        self.network = Transolver(
            N_INPUTS + 3, 3, width=width, layers=layers, heads=heads, slices=slices
        )

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Take the units of forces and displacements."""
        del seed
        self.inputs.fit(store, samples)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return kind and force of every point, (n_points, 6) float32."""
        return self.inputs.encode(load_case)

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3)."""
        graph.check_rows(inputs)
        places = self.places.expand(len(inputs), -1, -1)
        return self.inputs.displacement(self.network(torch.cat([inputs, places], -1)))

    def share_weights(self, other: Surrogate) -> None:
        """Take another body's network's weights for one's own, and its units."""
        if not isinstance(other, TransolverModel):
            raise InputError("a transolver takes the weights of another transolver")
        sizes = "width, layers, heads and slices"
        self.network = part_of_another(self.network, other.network, sizes)
        self.inputs.share_units(other.inputs)
