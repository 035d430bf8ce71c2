"""Sum and maximum over neighbours, on one shared graph."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.graph import Edges, Graph, Neighbours
from physgnn.learning.neighbour_kernels import largest, largest_back, total
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
    neighbours = graph.weighted if weighted else graph.plain
    if x.device.type != "cpu":
        return scattered(neighbours, x, aggregation)
    combine, back = AGGREGATIONS[aggregation].apply, torch.is_grad_enabled()
    combined: Tensor = combine(neighbours, x.contiguous(), back)  # type: ignore[no-untyped-call]
    return combined


class _Sum(torch.autograd.Function):
    """A sparse matrix times x; the way back is a product with its transpose."""

    @staticmethod
    def forward(ctx: Any, neighbours: Neighbours, x: Tensor, _: bool) -> Tensor:
        ctx.neighbours, ctx.n_columns = neighbours, x.shape[1]
        return _total(neighbours.edges, x.detach(), neighbours.graph.n_points)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, Tensor, None]:
        edges_back = ctx.neighbours.edges_back
        return None, _total(edges_back, grad.contiguous(), ctx.n_columns), None


def _total(edges: Edges, x: Tensor, n_rows: int) -> Tensor:
    y = x.new_empty(len(x), n_rows, x.shape[2])
    values, sums = x.numpy(), y.numpy()
    side_by_side(lambda rows: total(edges, values, sums, rows), shares(n_rows))
    return y


class _Maximum(torch.autograd.Function):
    """The largest value; its gradient is all for the neighbour it came from."""

    @staticmethod
    def forward(ctx: Any, neighbours: Neighbours, x: Tensor, back: bool) -> Tensor:
        y = x.new_empty(len(x), neighbours.graph.n_points, x.shape[2])
        which = torch.empty_like(y, dtype=torch.int32) if back else None
        values, maximum = x.detach().numpy(), y.numpy()
        edge = None if which is None else which.numpy()
        side_by_side(
            lambda rows: largest(neighbours.edges, values, maximum, edge, rows),
            shares(y.shape[1]),
        )
        ctx.save_for_backward(which)
        ctx.neighbours, ctx.n_columns = neighbours, x.shape[1]
        return y

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, Tensor, None]:
        (which,) = ctx.saved_tensors
        of_x = grad.new_zeros(len(grad), ctx.n_columns, grad.shape[2])
        edges = ctx.neighbours.edges
        of_y, edge, to = (t.numpy() for t in (grad.contiguous(), which, of_x))
        side_by_side(
            lambda columns: largest_back(edges, of_y, edge, to, columns),
            shares(grad.shape[2]),
        )
        return None, of_x, None


def scattered(neighbours: Neighbours, x: Tensor, aggregation: str) -> Tensor:
    """Gather and scatter: for devices that run no compiled kernels of ours."""
    graph = neighbours.graph
    messages = x[:, graph.column] * neighbours.value[:, None]
    nothing = x.new_zeros(len(x), graph.n_points, x.shape[2])
    row = graph.row[:, None].expand_as(messages)
    reduction = {"add": "sum", "max": "amax"}[aggregation]
    return nothing.scatter_reduce(1, row, messages, reduction, include_self=False)


AGGREGATIONS = {"add": _Sum, "max": _Maximum}
