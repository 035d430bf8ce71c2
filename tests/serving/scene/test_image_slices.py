from pathlib import Path

import nibabel
import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.serving.scene.image_slices import read_grey
from physgnn.serving.scene.section import AXES


def oblique_image(path: Path) -> np.ndarray:
    """Write a volume whose value is a linear function of the world's z and y."""
    affine = np.array(
        [[0, -2.0, 0.2, 30], [1.5, 0, 0, -20], [0, 0.1, 2.5, -25], [0, 0, 0, 1]]
    )
    index = np.indices((30, 32, 24)).reshape(3, -1)
    world = affine[:3, :3] @ index + affine[:3, 3:]
    values = (1000 + 10 * world[2] + 5 * world[1]).reshape(30, 32, 24)
    nibabel.Nifti1Image(values.astype(np.float32), affine).to_filename(path)
    return affine


@pytest.mark.parametrize("axis", ["sagittal", "axial"])
def test_a_slice_shows_the_world_place_it_should(tmp_path: Path, axis: str) -> None:
    oblique_image(tmp_path / "t1.nii.gz")
    image = read_grey(tmp_path / "t1.nii.gz")
    low, high = np.array([-10.0, -10.0, -10.0]), np.array([10.0, 10.0, 10.0])
    grey = image.slice(axis, 2.0, low, high).astype(float)
    assert grey.shape == (21, 21)
    others = [a for a in range(3) if a != AXES[axis]]
    slopes = [np.diff(grey, axis=k).mean() for k in (1, 0)]  # across, up
    per_mm = {0: 0.0, 1: 5.0, 2: 10.0}
    wanted = [per_mm[a] for a in others]
    np.testing.assert_allclose(
        np.array(slopes) * max(wanted), np.array(wanted) * max(slopes), atol=0.3
    )


def test_what_is_no_volume_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_grey(tmp_path / "absent.nii.gz")
    (tmp_path / "text.nii").write_text("hello")
    with pytest.raises(InputError, match="cannot be read"):
        read_grey(tmp_path / "text.nii")
    flat = nibabel.Nifti1Image(np.zeros((4, 4, 2, 3), np.float32), np.eye(4))
    flat.to_filename(tmp_path / "series.nii")
    with pytest.raises(InputError, match="series of 3 volumes"):
        read_grey(tmp_path / "series.nii")
