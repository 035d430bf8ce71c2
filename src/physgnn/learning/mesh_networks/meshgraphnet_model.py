"""MeshGraphNets between a load case and its displacement."""

import numpy as np
import torch
from torch import Tensor

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.graph import Graph, as_float32, graph_of
from physgnn.learning.mesh_networks.meshgraphnet import MeshGraphNet
from physgnn.learning.mesh_networks.node_inputs import N_INPUTS, NodeInputs
from physgnn.learning.network import Network
from physgnn.learning.shared_weights import part_of_another
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase


class MeshGraphNetModel(Network):
    """The static form: one pass from rest to the deformed state, no time steps.

    Points have their kind and force; edges have their relative position at rest, in
    units of the mean edge, so that nothing depends on where the head lies.

    Parameters
    ----------
    body : Body
        What is loaded.
    width : int
        Of the state of points and edges; 128 in Pfaff et al. 2021.
    steps : int
        Of message passing; 15 in Pfaff et al. 2021.
    """

    edge_inputs: Tensor

    def __init__(self, body: Body, *, width: int = 128, steps: int = 15) -> None:
        super().__init__(body)
        edges = edge_inputs(body.mesh.points, graph_of(body))
        self.register_buffer("edge_inputs", edges, persistent=False)
        self.inputs = NodeInputs(body)
        self.network = MeshGraphNet(N_INPUTS, 3, width=width, steps=steps)

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Take the units of forces and displacements."""
        del seed
        self.inputs.fit(store, samples)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return kind and force of every point, (n_points, 6) float32."""
        return self.inputs.encode(load_case)

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3)."""
        return self.inputs.displacement(self.network(inputs, self.edge_inputs, graph))

    def share_weights(self, other: Surrogate) -> None:
        """Take another body's network's weights for one's own, and its units."""
        if not isinstance(other, MeshGraphNetModel):
            raise InputError("a meshgraphnet takes the weights of another meshgraphnet")
        sizes = "width and steps"
        self.network = part_of_another(self.network, other.network, sizes)
        self.inputs.share_units(other.inputs)

    def spare_memory(self, spare: bool) -> None:
        """Keep no message for the backward pass and compute each twice, or keep all."""
        self.network.spare_memory = spare


def edge_inputs(points: FloatArray, graph: Graph) -> Tensor:
    """Return relative position and length of every edge, (n_edges, 4), in mean edges.

    Parameters
    ----------
    points : (n_points, 3) array
        At rest, mm.
    graph : Graph
        On the CPU.
    """
    apart = points[graph.column.numpy()] - points[graph.row.numpy()]
    length = np.linalg.norm(apart, axis=1, keepdims=True)
    inputs: Tensor = as_float32(np.hstack([apart, length]) / length.mean())
    return torch.nan_to_num(inputs)
