import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial import Delaunay
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.architecture import DEPTHS, Architecture
from physgnn.learning.physgnn.architecture import PUBLISHED_DEPTH as N_LAYERS
from physgnn.learning.physgnn.load_neighbourhood import LoadNeighbourhood
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.physgnn.pruning import NEIGHBOURHOODS_CACHED


@pytest.fixture(scope="module")
def graph() -> Graph:
    """A random graph of points in a long box, neighbours being near."""
    points = np.random.default_rng(0).uniform(0, (20, 3, 3), (1200, 3))
    cells = Delaunay(points).simplices
    corners = points[cells]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    longest = np.ptp(corners, axis=1).max(axis=1)
    cells = np.where(volume[:, None] > 0, cells, cells[:, [1, 0, 2, 3]])
    cells = cells[(longest < 1.5) & (abs(volume) > 1e-6)]
    return Graph.from_mesh(TetMesh(points, cells, np.zeros(len(cells))))


@pytest.fixture
def network() -> PhysGNN:
    torch.manual_seed(0)
    return PhysGNN(width=16).eval()


def loaded_features(graph: Graph, *, batch: int, nodes: list[int]) -> Tensor:
    generator = torch.Generator().manual_seed(0)
    kind = torch.randint(0, 2, (graph.n_points, 1), generator=generator).float()
    resting = torch.tensor([0.1, -0.2, 0.3, -0.1, -0.2, 0.05])
    x = torch.cat([kind, resting.expand(graph.n_points, 6)], dim=1)
    x = x.repeat(batch, 1, 1)
    x[:, nodes, 1:] += torch.randn(batch, len(nodes), 6, generator=generator)
    return x


def whole(network: PhysGNN, x: Tensor, graph: Graph) -> Tensor:
    last = network.outputs(x, [graph] * network.architecture.depth)[-1]
    return network.head[2:](last.flatten(0, 1)).view(*x.shape[:2], 3)


def distance(graph: Graph, nodes: list[int], most: int = N_LAYERS + 2) -> Tensor:
    """Hops from the nodes by powers of the adjacency matrix."""
    step = torch.eye(graph.n_points)
    step[graph.row, graph.column] = 1
    reached = torch.zeros(graph.n_points)
    reached[nodes] = 1
    hops = torch.full((graph.n_points,), 99)
    for k in range(most):
        hops[(reached > 0) & (hops == 99)] = k
        reached = (step @ reached).clamp(max=1)
    return hops


@torch.no_grad()
def test_pruned_equals_whole(graph: Graph, network: PhysGNN) -> None:
    for nodes in ([0], [5, 700], [0]):
        x = loaded_features(graph, batch=3, nodes=nodes)
        expected = whole(network, x, graph)
        rounding = 3e-6 * float(expected.max())
        torch.testing.assert_close(network(x, graph), expected, rtol=0, atol=rounding)


@torch.no_grad()
def test_far_outputs_do_not_depend_on_the_load(graph: Graph, network: PhysGNN) -> None:
    x = loaded_features(graph, batch=2, nodes=[0])
    far = distance(graph, [0]) > N_LAYERS
    assert far.any()
    y = whole(network, x, graph)
    assert torch.equal(y[0, far], y[1, far])
    assert not torch.equal(y[0, ~far], y[1, ~far])


def test_pruned_gradients_equal_those_of_the_whole(
    graph: Graph, network: PhysGNN
) -> None:
    network = network.double()
    double = replace(graph, weight=graph.weight.double())
    x = loaded_features(graph, batch=4, nodes=[0, 3]).double()
    gradients = []
    for y in (network(x, double), whole(network, x, double)):
        network.zero_grad()
        y.square().sum().backward()
        gradients.append([p.grad.clone() for p in network.parameters()])
    for pruned, expected in zip(*gradients, strict=True):
        torch.testing.assert_close(pruned, expected, rtol=1e-8, atol=1e-9)


@torch.no_grad()
def test_nothing_stale_is_used_after_a_change(graph: Graph, network: PhysGNN) -> None:
    x = loaded_features(graph, batch=1, nodes=[2])
    network(x, graph)
    for parameter in network.parameters():
        parameter.mul_(0.9)
    torch.testing.assert_close(network(x, graph), whole(network, x, graph))
    other = x.clone()
    other[..., 0] = 1 - other[..., 0]
    torch.testing.assert_close(network(other, graph), whole(network, other, graph))
    lighter = replace(graph, weight=graph.weight / 2)
    torch.testing.assert_close(network(x, lighter), whole(network, x, lighter))


@torch.no_grad()
def test_no_load_and_load_everywhere_are_computed_whole(
    graph: Graph, network: PhysGNN
) -> None:
    everywhere = torch.randn(1, graph.n_points, 7)
    for x in (loaded_features(graph, batch=1, nodes=[]), everywhere):
        torch.testing.assert_close(network(x, graph), whole(network, x, graph))


def test_reach_orders_points_by_hops_and_cuts_there(graph: Graph) -> None:
    nodes = [0, 400]
    loaded = torch.zeros(graph.n_points, dtype=torch.bool)
    loaded[nodes] = True
    neighbourhood = LoadNeighbourhood.of(graph, loaded, N_LAYERS)
    hops = distance(graph, nodes)
    assert (hops[neighbourhood.order].diff() >= 0).all()
    assert torch.equal(
        neighbourhood.order[neighbourhood.place], torch.arange(graph.n_points)
    )
    for k, (near, far) in enumerate(
        zip(neighbourhood.near, neighbourhood.far, strict=True), start=1
    ):
        assert near.n_points == (hops <= k).sum()
        assert near.n_columns == (hops <= k + 1).sum()
        assert far.n_points == (hops > k).sum()
        assert far.n_columns == (hops > k - 1).sum()
        for cut in (near, far):
            assert cut.column.max() < cut.n_columns


def test_what_predicting_kept_serves_for_training(
    graph: Graph, network: PhysGNN
) -> None:
    x = loaded_features(graph, batch=2, nodes=[0])
    with torch.inference_mode():
        network(x, graph)
    network(x, graph).sum().backward()


def test_a_load_that_just_neighbourhoods_everything(
    graph: Graph, network: PhysGNN
) -> None:
    hops = distance(graph, [0])
    ordered = graph.reordered(torch.argsort(hops, stable=True))
    n_inside = int((hops <= N_LAYERS).sum())
    inside = (ordered.row < n_inside) & (ordered.column < n_inside)
    small = Graph(
        torch.searchsorted(ordered.row[inside], torch.arange(n_inside + 1)),
        ordered.column[inside],
        ordered.weight[inside],
        n_inside,
    )
    x = loaded_features(small, batch=8, nodes=[0])
    torch.testing.assert_close(network(x, small), whole(network, x, small))
    network(x, small).sum().backward()


def test_a_prediction_stays_as_it_is_when_the_next_uses_its_memory(
    graph: Graph, network: PhysGNN
) -> None:
    loads = [loaded_features(graph, batch=1, nodes=nodes) for nodes in ([0], [5, 9])]
    alone = [whole(network, x, graph) for x in loads]
    with torch.inference_mode():
        found = [network(x, graph) for x in loads * 3]
    for x, expected in zip(found, alone * 3, strict=True):
        torch.testing.assert_close(x, expected.detach(), rtol=1e-5, atol=1e-6)


def test_of_many_loads_only_the_last_graphs_are_cached(
    network: PhysGNN, graph: Graph
) -> None:
    """At once: they are many megabytes, few objects, and no collector hurries."""
    network.train()
    seen = []
    gc.disable()
    try:
        for node in range(NEIGHBOURHOODS_CACHED + 4):
            x = loaded_features(graph, batch=4, nodes=[node])
            network(x, graph).sum().backward()
            (*_, (_, neighbourhood)) = network.pruning._neighbourhoods.values()
            seen += [
                weakref.ref(cut) for cut in (*neighbourhood.near, *neighbourhood.far)
            ]
            del neighbourhood
        alive = sum(ref() is not None for ref in seen)
    finally:
        gc.enable()
    assert alive == 2 * N_LAYERS * NEIGHBOURHOODS_CACHED


@pytest.mark.parametrize("nodes", [[0, 3], []])
def test_some_points_get_what_all_would_give_them(
    graph: Graph, network: PhysGNN, nodes: list[int]
) -> None:
    network = network.double()
    double = replace(graph, weight=graph.weight.double())
    x = loaded_features(graph, batch=3, nodes=nodes).double()
    near, far = (distance(graph, [0, 3]) <= N_LAYERS), torch.arange(graph.n_points)
    drawn = torch.randperm(graph.n_points, generator=torch.Generator().manual_seed(1))
    for points in (drawn[:200], far[~near][:50].flip(0), far[near][:50]):
        gradients = []
        for y in (network(x, double, points), whole(network, x, double)[:, points]):
            network.zero_grad()
            y.square().sum().backward()
            gradients.append([y.detach(), *(p.grad for p in network.parameters())])
            gradients[-1] = [value.clone() for value in gradients[-1]]
        for some, expected in zip(*gradients, strict=True):
            torch.testing.assert_close(some, expected, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("jumping", [True, False])
def test_other_architectures_carry_a_load_as_many_hops_as_they_have_layers(
    graph: Graph, depth: int, jumping: bool
) -> None:
    torch.manual_seed(0)
    architecture = Architecture(9, 1, depth, jumping_knowledge=jumping)
    network = PhysGNN(architecture, width=16).double().eval()
    x = loaded_features(graph, batch=2, nodes=[0, 3]).double()
    graph = replace(graph, weight=graph.weight.double())
    with torch.no_grad():
        found, resting = network(x, graph), whole(network, unloaded(x), graph)
        torch.testing.assert_close(found, whole(network, x, graph))
    moved = (found - resting).abs().amax(dim=(0, 2)) > 1e-14
    assert distance(graph, [0, 3], depth + 2)[moved].max() == depth
    some = torch.tensor([5, 2, 900])
    torch.testing.assert_close(network(x, graph, some), found[:, some])
    lstms = [module for module in network.modules() if isinstance(module, nn.LSTM)]
    assert len(lstms) == (2 if jumping else 0)


def unloaded(x: Tensor) -> Tensor:
    """Features without the load: all points have the last one's force columns."""
    return torch.cat([x[:, :, :1], x[:, -1:, 1:].expand(x.shape[0], x.shape[1], 6)], 2)
