import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.imaging import deformed_labels


@pytest.mark.parametrize("flip", [1.0, -1.0])
def test_volumes_follow_the_deformation_in_any_orientation(flip: float) -> None:
    mesh = block_mesh(4, side=20.0)
    u = mesh.points * [0.2, 0.0, -0.1]
    affine = np.diag([0.5 * flip, 0.5, 0.5, 1.0])
    affine[:3, 3] = -4.75 if flip > 0 else 29.75, -4.75, -4.75
    labels = deformed_labels(mesh, u, ImageGrid((70, 60, 60), affine))
    for region in (0, 1):
        wanted = mesh.cell_volumes[mesh.region == region].sum() * 1.2 * 0.9
        found = (labels.data == region + 1).sum() * labels.grid.voxel_volume_mm3
        assert found == pytest.approx(wanted, rel=0.03)
    x = labels.grid.to_world(np.argwhere(labels.data > 0))
    np.testing.assert_allclose(x.max(axis=0), [24.0, 20.0, 18.0], atol=0.5)


def test_a_grid_elsewhere_is_refused() -> None:
    mesh = block_mesh(2)
    far = np.eye(4)
    far[:3, 3] = 500.0
    with pytest.raises(InputError, match="do not meet"):
        deformed_labels(mesh, np.zeros_like(mesh.points), ImageGrid((8, 8, 8), far))
