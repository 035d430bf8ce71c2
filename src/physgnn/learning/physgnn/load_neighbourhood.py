"""The k-hop neighbourhood of the loads, and what of it each layer needs."""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor

from physgnn.learning.graph import Graph


class WantedRows(NamedTuple):
    """Where a neighbourhood has the points whose last output is wanted.

    Attributes
    ----------
    near, far : tensors
        Rows of the last layer's graph of that name, ascending.
    place : (n,) tensor
        Where each wanted point is in the rows of the near, followed by the far.
    """

    near: Tensor
    far: Tensor
    place: Tensor


@dataclass(frozen=True, eq=False)
class LoadNeighbourhood:
    """Points in the order in which messages from the loads arrive.

    In this order the points within k hops are the first ones, so that leaving out the
    others is taking the first rows of whatever there is.

    Attributes
    ----------
    order : (n_points,) tensor
        The points, nearest to the loads first.
    place : (n_points,) tensor
        The other way round: where each point is in that order.
    near : tuple of Graph
        One a layer: its rows the points reached after that layer, its columns these
        points and their neighbours.
    far : tuple of Graph
        One a layer, of the points in reverse order, farthest first: its rows the points
        whose output without load later layers need, its columns these points and their
        neighbours.
    """

    order: Tensor
    place: Tensor
    near: tuple[Graph, ...]
    far: tuple[Graph, ...]

    @classmethod
    def of(cls, graph: Graph, loaded: Tensor, n_layers: int) -> "LoadNeighbourhood":
        """Follow the edges from the loaded points, (n_points,) bool, n_layers deep."""
        # Cached for training as well, wherever it was first asked for.
        with torch.inference_mode(False):
            hops = _hops(graph, loaded, n_layers + 1)
            order = torch.argsort(hops, stable=True)
            within = [int((hops <= k).sum()) for k in range(n_layers + 2)]
            beyond = [graph.n_points - n for n in within]
            ahead, back = graph.reordered(order), graph.reordered(order.flip(0))
            layers = range(1, n_layers + 1)
            return cls(
                order,
                torch.argsort(order),
                tuple(ahead.cut(within[k], within[k + 1]) for k in layers),
                tuple(back.cut(beyond[k], beyond[k - 1]) for k in layers),
            )

    def wanted(self, points: Tensor) -> WantedRows:
        """Return where the wanted points are, each of which is given once."""
        rows, n_near = self.place[points], self.near[-1].n_points
        is_near = rows < n_near
        farthest_first = len(self.order) - 1 - rows
        key = torch.where(is_near, rows, n_near + farthest_first)
        return WantedRows(
            rows[is_near].sort().values,
            farthest_first[~is_near].sort().values,
            key.argsort().argsort(),
        )

    @property
    def fraction(self) -> float:
        """The part of a whole pass's rows that a sample computes."""
        return self._fraction(self.near)

    @property
    def fraction_without_load(self) -> float:
        """The part of a whole pass's rows that are needed without load."""
        return self._fraction(self.far)

    def _fraction(self, graphs: tuple[Graph, ...]) -> float:
        rows = sum(graph.n_points for graph in graphs)
        return rows / (len(graphs) * len(self.order))


def _hops(graph: Graph, loaded: Tensor, deepest: int) -> Tensor:
    """Return how many hops each point is from the loads, deepest + 1 if further."""
    hops = torch.full_like(loaded, deepest + 1, dtype=torch.int64)
    hops[loaded] = 0
    row = graph.row
    for k in range(1, deepest + 1):
        touched = row[hops[graph.column] == k - 1]
        hops[touched] = hops[touched].clamp(max=k)
    return hops
