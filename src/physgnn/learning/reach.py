"""Which points a load reaches through how many layers, and the graph cut to them."""

from dataclasses import dataclass

import torch
from torch import Tensor

from physgnn.learning.graph import Graph


@dataclass(frozen=True, eq=False)
class Reach:
    """Points in the order in which messages from the loads arrive.

    In this order the points within k hops are the first ones, so that leaving out the
    others is taking the first rows of whatever there is.

    Attributes
    ----------
    order : (n_points,) tensor
        The points, nearest to the loads first.
    place : (n_points,) tensor
        The other way round: where each point is in that order.
    graphs : tuple of Graph
        One a layer: its rows the points reached after that layer, its columns these
        points and their neighbours.
    """

    order: Tensor
    place: Tensor
    graphs: tuple[Graph, ...]

    @classmethod
    def of(cls, graph: Graph, loaded: Tensor, n_layers: int) -> "Reach":
        """Follow the edges from the loaded points, (n_points,) bool, n_layers deep."""
        hops = _hops(graph, loaded, n_layers + 1)
        order = torch.argsort(hops, stable=True)
        ordered = graph.reordered(order)
        within = [int((hops <= k).sum()) for k in range(n_layers + 2)]
        graphs = tuple(
            ordered.cut(within[k], within[k + 1]) for k in range(1, n_layers + 1)
        )
        return cls(order, torch.argsort(order), graphs)

    @property
    def share(self) -> float:
        """Return the part of a whole pass's rows that a pruned pass computes."""
        rows = sum(graph.n_points for graph in self.graphs)
        return rows / (len(self.graphs) * len(self.order))


def _hops(graph: Graph, loaded: Tensor, deepest: int) -> Tensor:
    """Return how many hops each point is from the loads, deepest + 1 if further."""
    hops = torch.full_like(loaded, deepest + 1, dtype=torch.int64)
    hops[loaded] = 0
    row = graph.row
    for k in range(1, deepest + 1):
        touched = row[hops[graph.column] == k - 1]
        hops[touched] = hops[touched].clamp(max=k)
    return hops
