"""Message passing on a shared graph, and attention over layers."""

import torch
from torch import Tensor, nn

from physgnn.learning.aggregation import aggregate
from physgnn.learning.graph import Graph


class Convolution(nn.Module):
    """W₁ · aggregate of the neighbours' (weighted) values + b + W₂ · own value.

    GraphConv (Morris et al. 2019) when the edges are weighted, SAGEConv (Hamilton et
    al. 2017) when they aren't; the two differ in nothing else here.

    Parameters
    ----------
    n_inputs, n_outputs : int
        Columns in and out.
    weighted : bool
        Whether a neighbour's value is multiplied by 1 / edge length.
    aggregation : {"add", "max"}
        How the neighbours' values become one.
    """

    def __init__(
        self, n_inputs: int, n_outputs: int, *, weighted: bool, aggregation: str
    ) -> None:
        super().__init__()
        self.weighted = weighted
        self.aggregation = aggregation
        self.neighbours = nn.Linear(n_inputs, n_outputs)
        self.root = nn.Linear(n_inputs, n_outputs, bias=False)

    def forward(self, x: Tensor, graph: Graph) -> Tensor:
        """Return (batch, n_points, n_outputs) for x (batch, n_points, n_inputs)."""
        message = aggregate(
            graph, x, weighted=self.weighted, aggregation=self.aggregation
        )
        output: Tensor = self.neighbours(message) + self.root(x)
        return output


class JumpingKnowledge(nn.Module):
    """Attention over the outputs of several layers, scored by a bidirectional LSTM.

    Jumping knowledge with LSTM attention (Xu et al. 2018): every point's layer outputs
    are read as a short sequence, hidden size width · layers / 2.

    Parameters
    ----------
    width : int
        Columns of each layer's output.
    n_layers : int
        Number of layers.
    """

    def __init__(self, width: int, n_layers: int) -> None:
        super().__init__()
        hidden = width * n_layers // 2
        self.lstm = nn.LSTM(width, hidden, bidirectional=True, batch_first=True)
        self.score = nn.Linear(2 * hidden, 1)

    def forward(self, layers: list[Tensor]) -> Tensor:
        """Return the layers' weighted mean, each (…, width)."""
        sequence = torch.stack([layer.flatten(0, -2) for layer in layers], dim=1)
        states, _ = self.lstm(sequence)
        attention = torch.softmax(self.score(states), dim=1)
        return (attention * sequence).sum(dim=1).view_as(layers[0])
