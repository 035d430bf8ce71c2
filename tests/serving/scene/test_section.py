import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.serving.scene.section import AXES, cut


def areas(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("offset", [0.1, 4.2, 9.7])
def test_a_section_of_a_cube_is_its_cross_section(
    block: TetMesh, axis: str, offset: float
) -> None:
    made = cut(block, axis, offset)
    points = made.at(block.points)
    np.testing.assert_allclose(points[:, AXES[axis]], offset, atol=1e-12)
    assert areas(points, made.faces).sum() == pytest.approx(100.0)


def test_regions_keep_their_share(block: TetMesh) -> None:
    made = cut(block, "sagittal", 3.0)
    area = areas(made.at(block.points), made.faces)
    assert area[made.region == 1].sum() == pytest.approx(area.sum() / 2, rel=0.2)


def test_a_linear_field_is_interpolated_exactly(block: TetMesh) -> None:
    gradient = np.array([[0.2, 0.1, 0], [0, -0.3, 0.4], [0.5, 0, 0.1]])
    made = cut(block, "coronal", 6.6)
    np.testing.assert_allclose(
        made.at(block.points @ gradient), made.at(block.points) @ gradient, atol=1e-12
    )


@pytest.mark.parametrize("offset", [-5.0, 15.0])
def test_a_plane_that_misses_the_body_is_empty(block: TetMesh, offset: float) -> None:
    made = cut(block, "axial", offset)
    assert made.faces.shape == (0, 3)
    assert made.at(block.points).shape == (0, 3)
