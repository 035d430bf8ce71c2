import itertools
from dataclasses import replace

import pytest
import torch

from learning.reference import random_pair
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.architecture import CONFIGURATIONS, Architecture
from physgnn.learning.physgnn.network import PhysGNN


def random_inputs(graph: Graph, *, batch: int = 2, seed: int = 0) -> torch.Tensor:
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(batch, graph.n_points, 7, generator=generator)


@pytest.fixture(scope="module")
def graph(block: TetMesh) -> Graph:
    return Graph.from_mesh(block)


every_network = pytest.mark.parametrize(
    ("configuration", "dataset"), list(itertools.product(CONFIGURATIONS, (1, 2)))
)


@every_network
def test_forward_equals_pytorch_geometric_to_float32_rounding(
    graph: Graph, configuration: int, dataset: int
) -> None:
    ours, reference = random_pair(configuration, dataset, width=16, seed=configuration)
    x = random_inputs(graph)
    with torch.inference_mode():
        torch.testing.assert_close(
            ours(x, graph), reference.on(graph, x), rtol=1e-4, atol=1e-5
        )


@every_network
def test_gradients_equal_pytorch_geometric(
    graph: Graph, configuration: int, dataset: int
) -> None:
    # In float64, where no two neighbours' values are so close that rounding decides
    # which of them is the largest and gets the gradient.
    pair = random_pair(configuration, dataset, width=16, seed=configuration)
    ours, reference = (network.double() for network in pair)
    double = replace(graph, weight=graph.weight.double())
    x = random_inputs(graph).double()
    ours(x, double).square().sum().backward()
    reference.on(double, x).square().sum().backward()
    expected = reference.our_gradients()
    for name, parameter in ours.named_parameters():
        # Entries are sums over points that cancel: the largest sets the rounding.
        scale = float(expected[name].abs().max())
        torch.testing.assert_close(
            parameter.grad, expected[name], rtol=0, atol=1e-9 * scale + 1e-12
        )


def test_size_as_published() -> None:
    assert sum(p.numel() for p in PhysGNN().parameters()) == 894_416


def test_one_sample_is_a_batch_of_one(graph: Graph) -> None:
    network = PhysGNN(width=8).eval()
    x = random_inputs(graph)
    torch.testing.assert_close(network(x[0], graph), network(x, graph)[0])


def test_layers_beyond_the_published_six_are_as_the_sixth() -> None:
    published, deep = Architecture(9, 1), Architecture(9, 1, 8)
    assert deep.layers == (*published.layers, *published.layers[-1:] * 2)
    assert Architecture(9, 1, 2).layers == published.layers[:2]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"configuration": 13}, "configuration"),
        ({"dataset": 3}, "dataset"),
        ({"depth": 5}, "depth"),
    ],
)
def test_refuses_an_architecture_there_is_not(
    options: dict[str, int], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Architecture(**options)


def test_refuses_an_odd_width() -> None:
    with pytest.raises(InputError, match="width"):
        PhysGNN(width=7)


def test_refuses_another_meshs_rows(graph: Graph) -> None:
    with pytest.raises(InputError, match="another mesh"):
        PhysGNN(width=8)(torch.zeros(3, 7), graph)
