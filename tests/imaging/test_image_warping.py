import numpy as np
import pytest

from imaging.conftest import centre_of, rigid, spot
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging import forward_field, inverse_field, warp


@pytest.mark.parametrize(
    ("interpolation", "within"), [("linear", 0.15), ("cubic", 0.15), ("nearest", 0.5)]
)
def test_the_image_moves_with_the_body(
    interpolation: str, within: float, block: TetMesh, oblique: ImageGrid
) -> None:
    shift = (1.2, -0.8, 0.6)
    u = rigid(block, (0, 0, 0), shift)
    image = spot(oblique, np.array([5.0, 5.0, 5.0]))
    before = image.data.copy()
    moved = warp(image, inverse_field(block, u, oblique), interpolation=interpolation)
    np.testing.assert_array_equal(image.data, before)
    assert moved.data.shape == image.data.shape
    np.testing.assert_allclose(centre_of(moved), np.add(5.0, shift), atol=within)


def test_nothing_moves_under_no_displacement(
    block: TetMesh, oblique: ImageGrid
) -> None:
    inverse = inverse_field(block, np.zeros_like(block.points), oblique)
    image = spot(oblique, np.array([2.0, 7.0, 5.0]))
    np.testing.assert_allclose(warp(image, inverse).data, image.data, atol=1e-6)


def test_labels_stay_labels(block: TetMesh, oblique: ImageGrid) -> None:
    labels = LabelVolume(
        (spot(oblique, np.full(3, 5.0)).data > 0.3) * 7, oblique.affine
    )
    u = rigid(block, (0, 0, 10), (1.0, 0.0, 0.0))
    moved = warp(labels, inverse_field(block, u, oblique))
    assert isinstance(moved, LabelVolume)
    assert set(np.unique(moved.data)) == {0, 7}
    assert (moved.data > 0).sum() == pytest.approx((labels.data > 0).sum(), rel=0.05)


def test_the_image_may_have_another_grid_than_the_field(
    block: TetMesh, oblique: ImageGrid
) -> None:
    fine = ImageGrid((40, 40, 40), np.diag([0.5, 0.5, 0.5, 1.0]))
    image = spot(fine, np.full(3, 5.0))
    u = rigid(block, (0, 0, 0), (0.0, 1.0, 0.0))
    moved = warp(image, inverse_field(block, u, oblique))
    np.testing.assert_allclose(centre_of(moved), [5.0, 6.0, 5.0], atol=0.15)


def test_wrong_input_is_refused(block: TetMesh, oblique: ImageGrid) -> None:
    image = spot(oblique, np.full(3, 5.0))
    u = np.zeros_like(block.points)
    with pytest.raises(InputError, match="interpolation must be"):
        warp(image, inverse_field(block, u, oblique), interpolation="sinc")
    with pytest.raises(InputError, match="inverse"):
        warp(image, forward_field(block, u, oblique))
