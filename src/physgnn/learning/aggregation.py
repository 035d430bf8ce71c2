"""Sum and maximum over neighbours, on one shared graph."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.graph import Graph, Neighbours
from physgnn.learning.maximum_kernels import largest, largest_back
from physgnn.learning.threads import shares, side_by_side


def aggregate(graph: Graph, x: Tensor, *, weighted: bool, aggregation: str) -> Tensor:
    """Combine the values of every point's neighbours.

    Parameters
    ----------
    graph : Graph
        The graph.
    x : (batch, graph.n_columns, columns) tensor
        Values.
    weighted : bool
        Multiply a neighbour's value by 1 / edge length first.
    aggregation : {"add", "max"}
        A row of ``AGGREGATIONS``. A point without neighbours gets 0.

    Returns
    -------
    (batch, n_points, columns) tensor
    """
    return AGGREGATIONS[aggregation](graph.weighted if weighted else graph.plain, x)


class _Product(torch.autograd.Function):
    """matrix @ x, whose way back is a product with the transpose, kept as well."""

    @staticmethod
    def forward(ctx: Any, neighbours: Neighbours, x: Tensor) -> Tensor:
        ctx.neighbours = neighbours
        return _products(neighbours.matrix, x)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, Tensor]:
        return None, _products(ctx.neighbours.transpose, grad.contiguous())


def _sum(neighbours: Neighbours, x: Tensor) -> Tensor:
    total: Tensor = _Product.apply(neighbours, x)  # type: ignore[no-untyped-call]
    return total


def _products(matrix: Tensor, x: Tensor) -> Tensor:
    """Multiply sample by sample: columns stay in cache; one wide product is slower."""
    y = x.new_empty(len(x), matrix.shape[0], x.shape[2])

    def part(samples: slice) -> None:
        for sample in range(samples.start, samples.stop):
            y[sample] = torch.sparse.mm(matrix, x[sample], "sum")

    side_by_side(part, shares(len(x), x.device))
    return y


class _Maximum(torch.autograd.Function):
    """The largest value; its gradient is all for the neighbour it came from."""

    @staticmethod
    def forward(ctx: Any, neighbours: Neighbours, x: Tensor) -> Tensor:
        y = x.new_empty(len(x), neighbours.graph.n_points, x.shape[2])
        which = torch.empty_like(y, dtype=torch.int32)
        values, maximum, edge = (t.detach().numpy() for t in (x, y, which))
        side_by_side(
            lambda rows: largest(neighbours.edges, values, maximum, edge, rows),
            shares(y.shape[1]),
        )
        ctx.save_for_backward(which)
        ctx.neighbours, ctx.n_columns = neighbours, x.shape[1]
        return y

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, Tensor]:
        (which,) = ctx.saved_tensors
        of_x = grad.new_zeros(len(grad), ctx.n_columns, grad.shape[2])
        edges = ctx.neighbours.edges
        of_y, edge, to = (t.numpy() for t in (grad.contiguous(), which, of_x))
        side_by_side(
            lambda columns: largest_back(edges, of_y, edge, to, columns),
            shares(grad.shape[2]),
        )
        return None, of_x


def _maximum(neighbours: Neighbours, x: Tensor) -> Tensor:
    if x.device.type != "cpu":
        return scattered_maximum(neighbours, x)
    largest_values: Tensor = _Maximum.apply(neighbours, x.contiguous())  # type: ignore[no-untyped-call]
    return largest_values


def scattered_maximum(neighbours: Neighbours, x: Tensor) -> Tensor:
    """Gather and scatter: for devices that run no compiled kernels of ours."""
    graph = neighbours.graph
    messages = x[:, graph.column] * neighbours.value[:, None]
    nothing = x.new_zeros(len(x), graph.n_points, x.shape[2])
    row = graph.row[:, None].expand_as(messages)
    return nothing.scatter_reduce(1, row, messages, "amax", include_self=False)


AGGREGATIONS = {"add": _sum, "max": _maximum}
