"""Gradients of the corners' linear functions."""

import numpy as np

from physgnn.geometry.tetmesh import TetMesh, shape_gradients


def test_gradients_of_the_corners_give_that_of_any_linear_field(block: TetMesh) -> None:
    rng = np.random.default_rng(0)
    A, b = rng.normal(size=(3, 3)), rng.normal(size=3)
    field = block.points @ A.T + b
    found = shape_gradients(block.points, block.cells)
    slope = np.einsum("eai,eaj->eij", field[block.cells], found)
    np.testing.assert_allclose(slope, np.broadcast_to(A, slope.shape), atol=1e-10)
    np.testing.assert_allclose(found.sum(axis=1), 0.0, atol=1e-14)
