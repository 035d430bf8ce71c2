"""The stencil, against fields whose mean and gradient are known."""

import numpy as np
import torch

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.lifted.mesh_gradient import Stencil, edge_lengths


def test_gradient_of_a_linear_field_is_exact(block: TetMesh) -> None:
    slope = np.array([0.3, -0.2, 0.5])
    field = torch.from_numpy((block.points @ slope)[None, :, None]).float()
    around = Stencil.from_cells(block.points, block.cells)(field)[0].numpy()
    length = edge_lengths(block.points, block.cells)
    np.testing.assert_allclose(
        around[:, 1:] / length[:, None], slope[None] + 0 * around[:, 1:], atol=1e-5
    )


def test_a_constant_field_gives_zero(block: TetMesh) -> None:
    around = Stencil.from_cells(block.points, block.cells)(
        torch.ones(2, block.n_points, 3)
    )
    assert around.shape == (2, block.n_points, 12)
    assert around.abs().max() < 1e-5


def test_first_row_is_the_neighbours_mean_less_the_value(block: TetMesh) -> None:
    value = np.random.default_rng(0).normal(size=block.n_points)
    around = Stencil.from_cells(block.points, block.cells)(
        torch.from_numpy(value[None, :, None]).float()
    )
    point = 17
    cells = block.cells[(block.cells == point).any(axis=1)]
    neighbours = np.setdiff1d(cells, point)
    expected = value[neighbours].mean() - value[point]
    assert abs(around[0, point, 0].item() - expected) < 1e-5


def test_backward_agrees_with_finite_differences(block: TetMesh) -> None:
    stencil = Stencil.from_cells(block.points, block.cells)
    double = Stencil(stencil.matrix.double(), stencil.transposed.double())
    x = torch.randn(1, block.n_points, 1, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(double, x)
