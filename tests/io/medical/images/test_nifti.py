from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io.medical.images.formats import read_image, read_segmentation, write_image

AFFINE = np.array(
    [[-1.0, 0, 0, 90], [0, 0.8, -0.6, -20], [0, 0.6, 0.8, 5], [0, 0, 0, 1]]
)


def test_image_and_labels_come_back(tmp_path: Path) -> None:
    values = np.random.default_rng(0).normal(size=(4, 5, 6))
    write_image(tmp_path / "t1.nii.gz", Image(values, AFFINE))
    back = read_image(tmp_path / "t1.nii.gz")
    np.testing.assert_allclose(back.data, values, rtol=1e-6)
    np.testing.assert_allclose(back.affine, AFFINE, atol=1e-6)
    labels = LabelVolume((values > 0).astype(np.int32) * 70_000, AFFINE)
    write_image(tmp_path / "seg.nii", labels)
    np.testing.assert_array_equal(
        read_segmentation(tmp_path / "seg.nii").data, labels.data
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["seg.nii", "t1.nii.gz"]


def test_a_fourth_axis_of_one_is_dropped_and_no_other(tmp_path: Path) -> None:
    for n, name in ((1, "one.nii"), (3, "three.nii")):
        image = nib.Nifti1Image(np.ones((4, 4, 4, n), dtype=np.float32), AFFINE)
        nib.save(image, tmp_path / name)
    assert read_image(tmp_path / "one.nii").data.shape == (4, 4, 4)
    with pytest.raises(InputError, match="three axes"):
        read_image(tmp_path / "three.nii")


def test_bad_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_image(tmp_path / "absent.nii")
    (tmp_path / "scan.dcm").write_bytes(b"x")
    with pytest.raises(InputError, match="DICOM files"):
        read_image(tmp_path / "scan.dcm")
    for name in ("text.nii", "text.nii.gz"):
        (tmp_path / name).write_text("this is no image" * 100)
        with pytest.raises(InputError, match="cannot be read"):
            read_image(tmp_path / name)
    noise = np.random.default_rng(0).normal(size=(20, 20, 20))
    write_image(tmp_path / "whole.nii.gz", Image(noise, AFFINE))
    cut = (tmp_path / "whole.nii.gz").read_bytes()[:5000]
    (tmp_path / "cut.nii.gz").write_bytes(cut)
    with pytest.raises(InputError, match="cannot be read"):
        read_image(tmp_path / "cut.nii.gz")
    nan = np.full((3, 3, 3), np.nan)
    nib.save(nib.Nifti1Image(nan, AFFINE), tmp_path / "nan.nii")
    with pytest.raises(InputError, match="NaN"):
        read_image(tmp_path / "nan.nii")
    with pytest.raises(InputError, match="written as"):
        write_image(tmp_path / "t1.png", Image(np.zeros((3, 3, 3)), AFFINE))
