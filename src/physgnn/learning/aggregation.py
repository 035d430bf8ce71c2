"""Sum and maximum over neighbours as products with one shared sparse matrix."""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.graph import Graph


def aggregate(graph: Graph, x: Tensor, *, weighted: bool, aggregation: str) -> Tensor:
    """Combine the values of every point's neighbours.

    One sample at a time: its columns stay in cache, which beats one wide product.

    Parameters
    ----------
    graph : Graph
        The graph.
    x : (batch, n_points, columns) tensor
        Values.
    weighted : bool
        Multiply a neighbour's value by 1 / edge length first.
    aggregation : {"add", "max"}
        A row of ``AGGREGATIONS``. A point without neighbours gets 0.

    Returns
    -------
    (batch, n_points, columns) tensor
    """
    matrix = graph.weighted if weighted else graph.plain
    product = AGGREGATIONS[aggregation]
    return torch.stack([product(matrix, sample) for sample in x])


class _SymmetricProduct(torch.autograd.Function):
    """matrix @ x for a symmetric matrix, which is then its own backward pass."""

    @staticmethod
    def forward(ctx: Any, matrix: Tensor, x: Tensor) -> Tensor:
        ctx.matrix = matrix
        return _product(matrix, x, "sum")

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, Tensor]:
        return None, _product(ctx.matrix, grad.contiguous(), "sum")


def _sum(matrix: Tensor, x: Tensor) -> Tensor:
    product: Tensor = _SymmetricProduct.apply(matrix, x)  # type: ignore[no-untyped-call]
    return product


def _maximum(matrix: Tensor, x: Tensor) -> Tensor:
    return _product(matrix, x, "amax")


def _product(matrix: Tensor, x: Tensor, reduce: str) -> Tensor:
    product: Tensor = torch.sparse.mm(matrix, x, reduce)
    return product


AGGREGATIONS = {"add": _sum, "max": _maximum}
