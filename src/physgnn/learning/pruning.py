"""Compute only what the load changes.

A network of six layers can't carry a load further than six hops, and layer k not
further than k. Beyond, every output is what it would be without any load: the same for
all samples on a mesh. It is computed once (for prediction, until weights, mesh or
features change; for training, once a batch) and each sample adds the rows its load
reaches. The result, and its gradient, are those of the whole computation.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

import torch
from torch import Tensor
from torch.nn import Parameter

from physgnn.learning.graph import Graph
from physgnn.learning.reach import Reach

Fill = Callable[[int, Tensor, int], Tensor]

KEPT_REACHES = 16
WORTHWHILE = 0.9


def keep_all(place: int, rows: Tensor, n_rows: int) -> Tensor:  # noqa: ARG001
    """Fill nothing in: all rows are there."""
    return rows


class Layered(Protocol):
    """A network that tells the output of each of its layers."""

    def outputs(
        self, x: Tensor, graphs: Sequence[Graph], fill: Fill = keep_all
    ) -> list[Tensor]:
        """See :meth:`physgnn.learning.physgnn.PhysGNN.outputs`."""

    def parameters(self) -> Iterator[Parameter]:
        """Return its weights."""


def unloaded(x: Tensor) -> tuple[Tensor, Tensor]:
    """Tell features of a body without load from what loads add to them.

    Without a load all points have the same force columns (standardised zeros), so
    these are the ones most points have.

    Parameters
    ----------
    x : (batch, n_points, 7) tensor
        Features, the property first.

    Returns
    -------
    background : (n_points, 7) tensor
        The first sample's features without its load.
    loaded : (n_points,) bool tensor
        Points at which any sample differs from that.
    """
    usual = torch.mode(x[0, :, 1]).values
    force = x[0, (x[0, :, 1] == usual).nonzero()[0, 0], 1:]
    background = torch.cat([x[0, :, :1], force.expand(x.shape[1], -1)], dim=1)
    return background, (x != background).any(dim=2).any(dim=0)


class Pruning:
    """What is kept between calls: where loads reached to, and outputs without load.

    Parameters
    ----------
    n_layers : int
        Of the network.
    """

    def __init__(self, n_layers: int) -> None:
        self.n_layers = n_layers
        self._reaches: OrderedDict[bytes, tuple[Graph, Reach]] = OrderedDict()
        self._background: tuple[Graph, Tensor, object, list[Tensor]] | None = None

    def last_output(self, network: Layered, x: Tensor, graph: Graph) -> Tensor | None:
        """Return the network's last output on all points, or None if it wouldn't pay.

        Parameters
        ----------
        network : Layered
            The network.
        x : (batch, n_points, 7) tensor
            Features.
        graph : Graph
            The whole graph.

        Returns
        -------
        (batch, n_points, columns) tensor or None
        """
        background, loaded = unloaded(x)
        if not loaded.any():
            return None
        reach = self._reach(graph, loaded)
        once_a_batch = torch.is_grad_enabled()
        if reach.share + once_a_batch / len(x) > WORTHWHILE:
            return None
        without_load = self._without_load(network, background, graph)

        def fill(place: int, rows: Tensor, n_rows: int) -> Tensor:
            have = rows.shape[1]
            if have >= n_rows:
                return rows[:, :n_rows]
            rest = without_load[place][0, reach.order[have:n_rows]]
            return torch.cat([rows, rest.expand(len(rows), -1, -1)], dim=1)

        outputs = network.outputs(x[:, reach.order], reach.graphs, fill)
        return fill(len(outputs) - 1, outputs[-1], graph.n_points)[:, reach.place]

    def _reach(self, graph: Graph, loaded: Tensor) -> Reach:
        key = loaded.cpu().numpy().tobytes()
        of_graph, reach = self._reaches.get(key, (None, None))
        if reach is None or of_graph is not graph:
            reach = Reach.of(graph, loaded, self.n_layers)
        self._reaches[key] = graph, reach
        self._reaches.move_to_end(key)
        if len(self._reaches) > KEPT_REACHES:
            self._reaches.popitem(last=False)
        return reach

    def _without_load(
        self, network: Layered, background: Tensor, graph: Graph
    ) -> list[Tensor]:
        if torch.is_grad_enabled():
            return network.outputs(background[None], [graph] * self.n_layers)
        weights = [(w.data_ptr(), w._version) for w in network.parameters()]
        if self._background is not None:
            of_graph, of_features, of_weights, outputs = self._background
            if (
                of_graph is graph
                and of_weights == weights
                and torch.equal(of_features, background)
            ):
                return outputs
        outputs = network.outputs(background[None], [graph] * self.n_layers)
        self._background = graph, background, weights, outputs
        return outputs
