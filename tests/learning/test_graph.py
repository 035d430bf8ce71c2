import numpy as np
import torch

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph

TETRAHEDRON = np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4]])


def test_a_tetrahedron_has_six_edges_both_ways_weighted_by_length() -> None:
    mesh = TetMesh(TETRAHEDRON, np.array([[0, 1, 2, 3]]), np.zeros(1))
    graph = Graph.from_mesh(mesh)
    lengths = np.linalg.norm(TETRAHEDRON[:, None] - TETRAHEDRON, axis=2)
    np.fill_diagonal(lengths, np.inf)
    np.testing.assert_allclose(graph.weighted.to_dense(), 1 / lengths, rtol=1e-6)
    np.testing.assert_array_equal(graph.plain.to_dense(), 1 - np.eye(4))


def test_edges_are_those_of_the_cells_once(block: TetMesh) -> None:
    graph = Graph.from_mesh(block)
    pairs = {
        (int(a), int(b)) for cell in block.cells for a in cell for b in cell if a != b
    }
    assert {(int(a), int(b)) for a, b in graph.edge_index.T} == pairs
    assert graph.n_edges == len(pairs)


def test_cut_keeps_the_first_rows_and_columns(block: TetMesh) -> None:
    graph = Graph.from_mesh(block)
    n_columns = int(graph.column[: graph.row_start[10]].max()) + 1
    cut = graph.cut(10, n_columns).weighted.to_dense()
    assert torch.equal(cut, graph.weighted.to_dense()[:10, :n_columns])


def test_reordered_renames_points_only(block: TetMesh) -> None:
    graph = Graph.from_mesh(block)
    order = torch.randperm(graph.n_points, generator=torch.Generator().manual_seed(0))
    renamed = graph.reordered(order).weighted.to_dense()
    assert torch.equal(renamed, graph.weighted.to_dense()[order][:, order])
