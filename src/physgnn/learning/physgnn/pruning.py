"""Compute only what the load changes.

A network of six layers can't carry a load further than six hops, and layer k not
further than k. Beyond, every output is what it would be without any load: the same for
all samples on a mesh. It is computed once (for prediction, until weights, mesh or
features change; for training, once a batch) and each sample adds the rows its load
reaches. The result, and its gradient, are those of the whole computation.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import NamedTuple, Protocol

import torch
from torch import Tensor
from torch.nn import Parameter

from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.load_neighbourhood import LoadNeighbourhood

Rest = Callable[[int, int, int], Tensor]
"""From an output's place in the list of them, a number of rows and another, to the
rows from the one to the other, (rows, columns), that are the same for all samples."""

NEIGHBOURHOODS_CACHED = 16
WORTHWHILE = 0.9


def filled(rows: Tensor, rest: Tensor) -> Tensor:
    """Append to each sample's rows those that are the same for all."""
    if not len(rest):
        return rows
    return torch.cat([rows, rest.expand(len(rows), -1, -1)], dim=1)


class Layered(Protocol):
    """A network that tells the output of each of its layers."""

    def outputs(
        self,
        x: Tensor,
        graphs: Sequence[Graph],
        rest: Rest | None = None,
        rows: Tensor | None = None,
    ) -> list[Tensor]:
        """See :meth:`physgnn.learning.physgnn.network.PhysGNN.outputs`."""

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


class _WithoutLoad(NamedTuple):
    """Outputs without load, and all that they rest on.

    Rows of them are picked once for the last neighbourhood asked for, so that whoever
    is given them can tell by the tensors that nothing changed.
    """

    graph: Graph
    background: Tensor
    weights: list[tuple[int, int]]
    outputs: list[Tensor]
    rest: dict[LoadNeighbourhood, Rest]


class Pruning:
    """Caches between calls: where loads reached to, and outputs without load.

    Parameters
    ----------
    n_layers : int
        Of the network.
    """

    def __init__(self, n_layers: int) -> None:
        self.n_layers = n_layers
        self._neighbourhoods: OrderedDict[bytes, tuple[Graph, LoadNeighbourhood]] = (
            OrderedDict()
        )
        self._cached: _WithoutLoad | None = None

    def forget(self) -> None:
        """Drop the outputs without load, as after a change of precision."""
        self._cached = None

    def last_output(
        self,
        network: Layered,
        x: Tensor,
        graph: Graph,
        points: Tensor | None = None,
    ) -> Tensor | None:
        """Return the network's last output, or None if pruning wouldn't pay.

        Parameters
        ----------
        network : Layered
            The network.
        x : (batch, n_points, 7) tensor
            Features.
        graph : Graph
            The whole graph.
        points : (n,) tensor, optional
            Points whose output is wanted, each once; by default all.

        Returns
        -------
        (batch, n, columns) tensor or None
        """
        background, loaded = unloaded(x)
        if not loaded.any():
            return None
        neighbourhood = self._neighbourhood(graph, loaded)
        training = torch.is_grad_enabled()
        once = neighbourhood.fraction_without_load if training else 0.0
        if neighbourhood.fraction + once / len(x) > WORTHWHILE:
            return None
        x = x[:, neighbourhood.order]
        if points is not None:
            wanted = neighbourhood.wanted(points)
            far_outputs = _on_far_points(network, background, neighbourhood, wanted.far)
            rest = _rest_of_far(far_outputs, neighbourhood)
            last = network.outputs(x, neighbourhood.near, rest, wanted.near)[-1]
            return filled(last, far_outputs[-1][0])[:, wanted.place]
        if training:
            far_outputs = _on_far_points(network, background, neighbourhood)
            rest = _rest_of_far(far_outputs, neighbourhood)
        else:
            rest = self._on_all_points(network, background, graph, neighbourhood)
        last = network.outputs(x, neighbourhood.near, rest)[-1]
        far = rest(-1, last.shape[1], graph.n_points)
        return filled(last, far)[:, neighbourhood.place]

    def _neighbourhood(self, graph: Graph, loaded: Tensor) -> LoadNeighbourhood:
        key = loaded.cpu().numpy().tobytes()
        of_graph, neighbourhood = self._neighbourhoods.get(key, (None, None))
        if neighbourhood is None or of_graph is not graph:
            neighbourhood = LoadNeighbourhood.of(graph, loaded, self.n_layers)
        self._neighbourhoods[key] = graph, neighbourhood
        self._neighbourhoods.move_to_end(key)
        if len(self._neighbourhoods) > NEIGHBOURHOODS_CACHED:
            self._neighbourhoods.popitem(last=False)
        return neighbourhood

    def _on_all_points(
        self,
        network: Layered,
        background: Tensor,
        graph: Graph,
        neighbourhood: LoadNeighbourhood,
    ) -> Rest:
        """Compute outputs without load once, until something they rest on changes."""
        weights = [(w.data_ptr(), w._version) for w in network.parameters()]
        cached = self._cached
        if not (
            cached
            and cached.graph is graph
            and cached.weights == weights
            and torch.equal(cached.background, background)
        ):
            outputs = network.outputs(background[None], [graph] * self.n_layers)
            cached = self._cached = _WithoutLoad(
                graph, background, weights, outputs, {}
            )
        if neighbourhood not in cached.rest:
            cached.rest.clear()
            cached.rest[neighbourhood] = _rest_of(cached.outputs, neighbourhood)
        return cached.rest[neighbourhood]


def _on_far_points(
    network: Layered,
    background: Tensor,
    neighbourhood: LoadNeighbourhood,
    rows: Tensor | None = None,
) -> list[Tensor]:
    """Compute outputs without load where they're used, for this batch alone."""
    farthest_first = background[neighbourhood.order.flip(0)][None]
    return network.outputs(farthest_first, neighbourhood.far, None, rows)


def _rest_of_far(outputs: list[Tensor], neighbourhood: LoadNeighbourhood) -> Rest:
    n_points = len(neighbourhood.order)
    return lambda place, have, n_rows: outputs[place][
        0, n_points - n_rows : n_points - have
    ].flip(0)


def _rest_of(outputs: list[Tensor], neighbourhood: LoadNeighbourhood) -> Rest:
    @cache
    def rest(place: int, have: int, n_rows: int) -> Tensor:
        return outputs[place][0, neighbourhood.order[have:n_rows]]

    return rest
