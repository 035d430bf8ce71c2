import numpy as np
import pytest

from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import folding, inverse_field, jacobian_image
from physgnn.imaging.jacobian import cell_jacobians
from physgnn.mechanics import deformation_gradient


def test_determinant_is_that_of_the_mechanics(block: TetMesh) -> None:
    u = np.random.default_rng(0).normal(scale=0.1, size=block.points.shape)
    expected = np.linalg.det(deformation_gradient(block, u))
    np.testing.assert_allclose(cell_jacobians(block, u), expected, rtol=1e-10)


def test_map_of_a_stretch(block: TetMesh, oblique: ImageGrid) -> None:
    u = block.points * [0.1, 0.0, -0.05]
    image = jacobian_image(block, u, oblique)
    assert set(np.unique(image.data.round(5))) == {1.0, np.float32(1.045)}
    found = folding(block, u, inverse_field(block, u, oblique))
    assert found.smallest == pytest.approx(1.045) == found.largest
    assert found.cells == found.voxels_inside == found.voxels_outside == 0
    assert "nothing folds" in str(found)


def test_a_fold_is_reported(block: TetMesh, oblique: ImageGrid) -> None:
    u = np.zeros_like(block.points)
    inner = np.flatnonzero(((block.points > 2) & (block.points < 8)).all(axis=1))[0]
    u[inner] = [6.0, 0.0, 0.0]
    found = folding(block, u, inverse_field(block, u, oblique))
    assert found.cells > 0 and found.smallest < 0
    assert "FOLDED" in str(found)
