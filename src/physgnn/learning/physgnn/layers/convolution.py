"""One layer of message passing on a shared graph."""

from torch import Tensor, nn

from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.layers.aggregation import aggregate


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
        """Return (batch, n_points, n_outputs) for x (batch, n_columns, n_inputs)."""
        message = aggregate(
            graph, x, weighted=self.weighted, aggregation=self.aggregation
        )
        own = x[:, : graph.n_points]
        output: Tensor = self.neighbours(message) + self.root(own)
        return output
