import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.serving.scene.sample_grid import grid_over


@pytest.mark.parametrize("spacing", [1.1, 2.5])
def test_a_linear_field_is_interpolated_exactly_inside(
    block: TetMesh, spacing: float
) -> None:
    grid = grid_over(block, spacing)
    nx, ny, nz = grid.shape
    k, j, i = np.indices((nz, ny, nx))
    world = np.stack([i, j, k, np.ones_like(i)], -1) @ grid.to_world.T
    inside = (world[..., :3] <= 10.0).all(axis=-1)
    found = grid.at(block.points)
    np.testing.assert_allclose(found[inside], world[inside][:, :3], atol=1e-9)
    assert not found[~inside].any()
