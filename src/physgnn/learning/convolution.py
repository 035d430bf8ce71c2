"""One layer of message passing on a shared graph, with its activation."""

from torch import Tensor, nn

from physgnn.learning.aggregation import aggregate
from physgnn.learning.dense import dense
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

    def forward(self, x: Tensor, graph: Graph, activation: nn.PReLU) -> Tensor:
        """Return (batch, n_points, n_outputs) for x (batch, n_columns, n_inputs)."""
        message = aggregate(
            graph, x, weighted=self.weighted, aggregation=self.aggregation
        )
        return dense(
            (message, x[:, : graph.n_points]),
            (self.neighbours.weight, self.root.weight),
            self.neighbours.bias,
            activation.weight,
        )
