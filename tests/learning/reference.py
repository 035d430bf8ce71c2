"""The published network out of PyTorch Geometric's layers: what ours must equal."""

import warnings

import torch
from torch import Tensor, nn

from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.architecture import CONFIGURATIONS, Architecture
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.physgnn.published import our_name

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from torch_geometric.nn import (
        GraphConv,
        JumpingKnowledge,
        MessagePassing,
        SAGEConv,
    )

__all__ = ["JumpingKnowledge", "MessagePassing", "random_pair", "reference_of"]


class ReferencePhysGNN(nn.Module):
    """The published network out of PyTorch Geometric's own layers."""

    def __init__(self, configuration: int, dataset: int, width: int) -> None:
        super().__init__()
        layers, *aggregations = CONFIGURATIONS[configuration]
        self.layers = layers
        for i, (layer, letter) in enumerate(
            zip(layers, aggregations[dataset - 1], strict=True), start=1
        ):
            kind = {"G": GraphConv, "S": SAGEConv}[layer]
            convolution = kind(
                7 if i == 1 else width, width, aggr={"a": "add", "m": "max"}[letter]
            )
            setattr(self, f"conv{i}", convolution)
            setattr(self, f"active{i}", nn.PReLU(width))
        self.jk1 = JumpingKnowledge("lstm", width, 3)
        self.jk2 = JumpingKnowledge("lstm", width, 3)
        narrow = width * 9 // 16
        self.lin1 = nn.Linear(width, narrow)
        self.active7 = nn.PReLU(narrow)
        self.lin2 = nn.Linear(narrow, 3)

    def forward(self, x: Tensor, edge_index: Tensor, edge_weight: Tensor) -> Tensor:
        for block, attention in enumerate((self.jk1, self.jk2)):
            outputs = []
            for i in range(3 * block + 1, 3 * block + 4):
                weight = (edge_weight,) if self.layers[i - 1] == "G" else ()
                x = getattr(self, f"conv{i}")(x, edge_index, *weight)
                x = getattr(self, f"active{i}")(x)
                outputs.append(x)
            x = attention(outputs)
        x = nn.functional.dropout(self.active7(self.lin1(x)), 0.1, self.training)
        return self.lin2(x)

    def on(self, graph: Graph, x: Tensor) -> Tensor:
        """Apply to every sample of a batch."""
        return torch.stack([self(s, graph.edge_index, graph.weight) for s in x])

    def our_gradients(self) -> dict[str, Tensor]:
        """Gradients by our parameters' names."""
        return {our_name(n): p.grad for n, p in self.named_parameters()}


def reference_of(ours: PhysGNN, configuration: int, dataset: int) -> ReferencePhysGNN:
    """Return the reference with the weights of ours, in evaluation mode."""
    reference = ReferencePhysGNN(configuration, dataset, ours.width)
    state = ours.state_dict()
    reference.load_state_dict(
        {name: state[our_name(name)] for name in reference.state_dict()}
    )
    return reference.eval()


def random_pair(
    configuration: int, dataset: int, width: int, seed: int = 0
) -> tuple[PhysGNN, ReferencePhysGNN]:
    """Return our network with random weights, and the reference with the same."""
    torch.manual_seed(seed)
    ours = PhysGNN(Architecture(configuration, dataset), width).eval()
    for activation in (m for m in ours.modules() if isinstance(m, nn.PReLU)):
        nn.init.uniform_(activation.weight, -0.5, 0.5)
    return ours, reference_of(ours, configuration, dataset)
