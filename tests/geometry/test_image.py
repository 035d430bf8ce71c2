import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.geometry.image import Image, ImageGrid, LabelVolume

ANGLES = st.floats(-180, 180)


@given(ANGLES, ANGLES, st.sampled_from([1, -1]))
def test_world_and_index_are_inverse_and_voxel_sizes_are_kept(
    yaw: float, roll: float, flip: int
) -> None:
    turn = Rotation.from_euler("zx", [yaw, roll], degrees=True).as_matrix()
    affine = np.eye(4)
    affine[:3, :3] = turn @ np.diag([flip * 0.5, 1.0, 3.0])
    affine[:3, 3] = [10, -20, 30]
    grid = ImageGrid((4, 5, 6), affine)
    np.testing.assert_allclose(grid.voxel_mm, [0.5, 1.0, 3.0])
    assert grid.voxel_volume_mm3 == pytest.approx(1.5)
    index = np.array([[0, 0, 0], [1.5, 2, 4]])
    np.testing.assert_allclose(grid.to_index(grid.to_world(index)), index, atol=1e-9)
    np.testing.assert_allclose(grid.to_world([[0, 0, 0]]), [[10, -20, 30]])


def test_refusals_say_what_came() -> None:
    sheared = np.eye(4)
    sheared[0, 1] = 0.2
    for shape, affine, text in (
        ((4, 4), np.eye(4), r"shape \(4, 4\)"),
        ((4, 1, 4), np.eye(4), "two voxels"),
        ((4, 4, 4), np.diag([1.0, 0.0, 1.0, 1.0]), "size in mm"),
        ((4, 4, 4), np.full((4, 4), np.nan), "finite"),
        ((4, 4, 4), sheared, "right angles"),
    ):
        with pytest.raises(InputError, match=text):
            ImageGrid(shape, affine)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="three axes"):
        Image(np.zeros((3, 3)), np.eye(4))
    with pytest.raises(InputError, match="whole numbers"):
        LabelVolume(np.full((3, 3, 3), 0.5), np.eye(4))  # type: ignore[arg-type]
    labels = np.ones((5, 5, 5))
    labels[2, 2, 2] = 1.25
    with pytest.raises(InputError, match=r"1 of its 125 .* 1\.25.*nearest"):
        LabelVolume(labels, np.eye(4))  # type: ignore[arg-type]
    for label in (2**31, 2**40, -(2**31) - 1, float(2**40), np.uint64(2**63)):
        with pytest.raises(InputError, match=r"labels must be in .*got -?\d{10}"):
            LabelVolume(np.full((3, 3, 3), label), np.eye(4))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="empty"):
        LabelVolume(np.zeros((3, 3, 3), dtype=np.int32), np.eye(4))
