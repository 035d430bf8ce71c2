"""Messages go along edges, as far as there are steps, and as the paper's sums say."""

import numpy as np
import torch

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.mesh_networks.meshgraphnet import MeshGraphNet, MessagePassing
from physgnn.learning.mesh_networks.meshgraphnet_model import edge_inputs

N_INPUTS, WIDTH = 5, 8


def states(graph: Graph) -> tuple[torch.Tensor, torch.Tensor]:
    torch.manual_seed(0)
    nodes = torch.randn(2, graph.n_points, WIDTH)
    return nodes, torch.randn(2, graph.n_edges, WIDTH)


def test_a_step_is_the_papers_edge_by_edge(block: TetMesh) -> None:
    """Written out for every edge and point, with whole concatenated inputs."""
    graph = Graph.from_mesh(block)
    nodes, edges = states(graph)
    step = MessagePassing(WIDTH)
    found_nodes, found_edges = step(nodes, edges, graph.column, graph.row)
    messages = {}
    for edge, (source, target) in enumerate(graph.edge_index.T.tolist()):
        state = torch.cat([edges[:, edge], nodes[:, source], nodes[:, target]], dim=-1)
        messages[edge] = edges[:, edge] + step.edge(state)
        torch.testing.assert_close(found_edges[:, edge], messages[edge])
    for point in range(graph.n_points):
        first, last = graph.row_start[point : point + 2].tolist()
        received = torch.stack([messages[edge] for edge in range(first, last)]).sum(0)
        state = torch.cat([received, nodes[:, point]], dim=-1)
        torch.testing.assert_close(
            found_nodes[:, point], nodes[:, point] + step.node(state)
        )


def test_a_point_hears_of_what_is_as_many_edges_away_as_there_are_steps(
    block: TetMesh,
) -> None:
    graph = Graph.from_mesh(block)
    hops = edges_from(graph, 0)
    network = MeshGraphNet(N_INPUTS, 3, width=WIDTH, steps=2).eval()
    edges = edge_inputs(block.points, graph)
    inputs = torch.zeros(1, graph.n_points, N_INPUTS)
    before = network(inputs, edges, graph)
    inputs[0, 0] = 1.0
    moved = (network(inputs, edges, graph) != before).any(dim=-1)[0].numpy()
    np.testing.assert_array_equal(moved, hops <= 2)
    assert (hops > 2).any()


def edges_from(graph: Graph, start: int) -> np.ndarray:
    hops = np.full(graph.n_points, graph.n_points)
    hops[start] = 0
    for _ in range(graph.n_points):
        for source, target in graph.edge_index.T.tolist():
            hops[target] = min(hops[target], hops[source] + 1)
    return hops


def test_edges_do_not_depend_on_place_or_unit(block: TetMesh) -> None:
    graph = Graph.from_mesh(block)
    here = edge_inputs(block.points, graph)
    there = edge_inputs(10 * block.points + [5.0, -70.0, 3.0], graph)
    torch.testing.assert_close(here, there)
    torch.testing.assert_close(here[:, :3].norm(dim=1), here[:, 3])


def test_short_memory_changes_no_gradient(block: TetMesh) -> None:
    graph = Graph.from_mesh(block)
    torch.manual_seed(0)
    network = MeshGraphNet(N_INPUTS, 3, width=WIDTH, steps=2).train()
    inputs = torch.randn(1, graph.n_points, N_INPUTS)
    edges, gradients = edge_inputs(block.points, graph), []
    for spare in (False, True):
        network.spare_memory = spare
        network.zero_grad()
        network(inputs, edges, graph).square().sum().backward()
        gradients.append([weight.grad.clone() for weight in network.parameters()])
    for kept, again in zip(*gradients, strict=True):
        torch.testing.assert_close(kept, again)
