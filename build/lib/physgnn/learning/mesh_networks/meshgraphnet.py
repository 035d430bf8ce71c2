"""MeshGraphNets: encode, pass messages, decode (Pfaff et al. 2021, section 3.2)."""

from collections.abc import Callable

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.utils.checkpoint import checkpoint

from physgnn.learning.graph import Graph

N_EDGE_INPUTS = 4  # relative position and its length


def perceptron(
    n_inputs: int, width: int, n_outputs: int, *, norm: bool
) -> nn.Sequential:
    """Return two hidden layers with ReLU, and a LayerNorm at the end if asked for."""
    layers = [
        nn.Linear(n_inputs, width), nn.ReLU(),
        nn.Linear(width, width), nn.ReLU(),
        nn.Linear(width, n_outputs),
    ]  # fmt: skip
    return nn.Sequential(*layers, *([nn.LayerNorm(n_outputs)] if norm else []))


class MessagePassing(nn.Module):
    """One step: eᵢⱼ ← eᵢⱼ + f(eᵢⱼ, vᵢ, vⱼ), then vⱼ ← vⱼ + g(vⱼ, Σᵢ eᵢⱼ).

    Parameters
    ----------
    width : int
        Of the state of points and of edges.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width
        self.edge = perceptron(3 * width, width, width, norm=True)
        self.node = perceptron(2 * width, width, width, norm=True)

    def forward(
        self, nodes: Tensor, edges: Tensor, source: Tensor, target: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Return the states after the step, (batch, n_points | n_edges, width)."""
        edges = edges + self._message(nodes, edges, source, target)
        received = torch.zeros_like(nodes).index_add(1, target, edges)
        return nodes + self.node(torch.cat([received, nodes], dim=-1)), edges

    def _message(
        self, nodes: Tensor, edges: Tensor, source: Tensor, target: Tensor
    ) -> Tensor:
        """Return f; its first layer is applied to points before they are gathered.

        The same sum, in as many products as there are points, not edges.
        """
        first, *others = self.edge.children()
        assert isinstance(first, nn.Linear)
        of_edge, of_source, of_target = first.weight.chunk(3, dim=1)
        state = functional.linear(edges, of_edge, first.bias)
        state = state + functional.linear(nodes, of_source)[:, source]
        state = state + functional.linear(nodes, of_target)[:, target]
        for layer in others:
            state = layer(state)
        return state


class MeshGraphNet(nn.Module):
    """Perceptrons for points and edges, message passing, a perceptron for outputs.

    Parameters
    ----------
    n_inputs, n_outputs : int
        Columns of points.
    width : int
        Of all states.
    steps : int
        Of message passing; the paper has 15.
    """

    def __init__(
        self, n_inputs: int, n_outputs: int, *, width: int = 128, steps: int = 15
    ) -> None:
        super().__init__()
        self.node_encoder = perceptron(n_inputs, width, width, norm=True)
        self.edge_encoder = perceptron(N_EDGE_INPUTS, width, width, norm=True)
        self.steps = nn.ModuleList(MessagePassing(width) for _ in range(steps))
        self.decoder = perceptron(width, width, n_outputs, norm=False)
        self.spare_memory = False

    def forward(self, inputs: Tensor, edge_inputs: Tensor, graph: Graph) -> Tensor:
        """Return outputs (batch, n_points, n_outputs).

        Parameters
        ----------
        inputs : (batch, n_points, n_inputs) tensor
            Of every point.
        edge_inputs : (n_edges, 4) tensor
            Source less target in units of a typical edge, and the length of that.
        graph : Graph
            Whose rows are targets and whose columns are sources.
        """
        graph.check_rows(inputs)
        source, target = graph.column, graph.row
        nodes = self.node_encoder(inputs)
        edges = self.edge_encoder(edge_inputs).expand(len(inputs), -1, -1)
        for step in self.steps:
            nodes, edges = self._run(step)(nodes, edges, source, target)
        outputs: Tensor = self.decoder(nodes)
        return outputs

    def _run(self, step: nn.Module) -> Callable[..., tuple[Tensor, Tensor]]:
        """Return the step, computed twice in training where memory is short."""
        if not (self.spare_memory and self.training):
            return step
        return lambda *states: checkpoint(step, *states, use_reentrant=False)
