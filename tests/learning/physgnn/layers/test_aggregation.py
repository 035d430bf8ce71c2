from dataclasses import replace

import pytest
import torch
from torch import Tensor

from learning.reference import MessagePassing
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.layers.aggregation import (
    AGGREGATIONS,
    aggregate,
    scattered,
)

kinds = pytest.mark.parametrize("aggregation", AGGREGATIONS)
weights = pytest.mark.parametrize("weighted", [True, False])


class Oracle(MessagePassing):
    """Gather, weigh, scatter."""

    def forward(self, x: Tensor, graph: Graph, weighted: bool) -> Tensor:
        weight = graph.weight if weighted else torch.ones_like(graph.weight)
        return self.propagate(graph.edge_index, x=x, weight=weight)

    def message(self, x_j: Tensor, weight: Tensor) -> Tensor:
        return weight[:, None] * x_j


@kinds
@weights
def test_equals_gather_and_scatter(
    block: TetMesh, aggregation: str, weighted: bool
) -> None:
    graph = Graph.from_mesh(block)
    x = torch.randn(3, graph.n_points, 5, generator=torch.Generator().manual_seed(0))
    y = aggregate(graph, x, weighted=weighted, aggregation=aggregation)
    oracle = Oracle(aggr=aggregation)
    for ours, sample in zip(y, x, strict=True):
        torch.testing.assert_close(ours, oracle(sample, graph, weighted))


@kinds
@weights
def test_other_devices_gather_and_scatter_to_the_same(
    block: TetMesh, aggregation: str, weighted: bool
) -> None:
    graph = Graph.from_mesh(block)
    x = torch.randn(3, graph.n_points, 5, generator=torch.Generator().manual_seed(0))
    by_matrix = aggregate(graph, x, weighted=weighted, aggregation=aggregation)
    reduction = AGGREGATIONS[aggregation]
    by_scattering = scattered(graph, x, weighted=weighted, reduction=reduction)
    torch.testing.assert_close(by_scattering, by_matrix)


@kinds
@weights
def test_gradient_is_that_of_the_values(
    block: TetMesh, aggregation: str, weighted: bool
) -> None:
    graph = Graph.from_mesh(block)
    graph = replace(graph, weight=graph.weight.double())
    generator = torch.Generator().manual_seed(0)
    x = torch.randn(2, graph.n_points, 1, generator=generator).double()
    assert torch.autograd.gradcheck(
        lambda values: aggregate(
            graph, values, weighted=weighted, aggregation=aggregation
        ),
        x.requires_grad_(),
    )


@kinds
def test_a_point_without_neighbours_gets_zero(aggregation: str) -> None:
    graph = Graph(
        torch.tensor([0, 1, 2, 2]), torch.tensor([1, 0]), torch.tensor([2.0, 2.0]), 3
    )
    x = torch.tensor([[[-1.0], [-3.0], [5.0]]])
    y = aggregate(graph, x, weighted=True, aggregation=aggregation)
    assert y.tolist() == [[[-6.0], [-2.0], [0.0]]]


def test_what_predicting_asked_for_first_serves_training(block: TetMesh) -> None:
    graph, x = Graph.from_mesh(block), torch.ones(1, block.n_points, 2)
    for weighted in (True, False):
        with torch.inference_mode():
            aggregate(graph, x, weighted=weighted, aggregation="add")
        trained = x.clone().requires_grad_()
        aggregate(graph, trained, weighted=weighted, aggregation="add").sum().backward()
        assert trained.grad is not None
