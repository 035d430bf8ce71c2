"""Sum and maximum over neighbours, on one shared graph."""

import torch
from torch import Tensor

from physgnn.learning.graph import Graph

# How to aggregate: what torch calls it in sparse products, and in scattering.
AGGREGATIONS = {"add": "sum", "max": "amax"}


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
    reduction = AGGREGATIONS[aggregation]
    if x.device.type != "cpu":  # torch.sparse.mm reduces on the CPU alone
        return scattered(graph, x, weighted=weighted, reduction=reduction)
    matrix = graph.weighted if weighted else graph.plain
    return torch.stack([torch.sparse.mm(matrix, sample, reduction) for sample in x])


def scattered(graph: Graph, x: Tensor, *, weighted: bool, reduction: str) -> Tensor:
    """Gather a message an edge and scatter the messages to the points."""
    messages = x[:, graph.column]
    if weighted:
        messages = messages * graph.weight[:, None]
    nothing = x.new_zeros(len(x), graph.n_points, x.shape[2])
    row = graph.row[:, None].expand_as(messages)
    return nothing.scatter_reduce(1, row, messages, reduction, include_self=False)
