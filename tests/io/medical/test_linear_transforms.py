from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.io.medical.linear_transforms import read_rigid_transform, transformed

TO_SCAN = np.eye(4)
TO_SCAN[:3, :3] = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
TO_SCAN[:3, 3] = [12.0, -7.0, 30.0]
LPS = np.diag([-1.0, -1.0, 1.0])


def itk_file(path: Path, matrix: np.ndarray) -> Path:
    """As ITK and 3D Slicer write what takes measured points to the scan."""
    back = np.linalg.inv(matrix)
    transform = sitk.AffineTransform(3)
    transform.SetMatrix((LPS @ back[:3, :3] @ LPS).ravel().tolist())
    transform.SetTranslation((LPS @ back[:3, 3]).tolist())
    sitk.WriteTransform(transform, str(path))
    return path


@pytest.mark.parametrize("name", ["t.tfm", "t.h5"])
def test_an_itk_file_takes_measured_points_to_the_scan(
    tmp_path: Path, name: str
) -> None:
    """The file takes points of the scan to the tracker: there and back is nowhere."""
    path = itk_file(tmp_path / name, TO_SCAN)
    matrix = read_rigid_transform(path)
    np.testing.assert_allclose(matrix, TO_SCAN, atol=1e-9)
    tracker = np.array([[10.0, 20.0, 30.0], [-5.0, 0.0, 2.0]])
    scan = transformed(matrix, tracker)
    itk = sitk.ReadTransform(str(path))
    for before, after in zip(tracker, scan, strict=True):
        back = itk.TransformPoint((LPS @ after).tolist())
        np.testing.assert_allclose(LPS @ back, before, atol=1e-9)


def test_a_matrix_as_text_is_taken_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "t.txt"
    np.savetxt(path, TO_SCAN, header="tracker to scan")
    np.testing.assert_allclose(read_rigid_transform(path), TO_SCAN)


@pytest.mark.parametrize(
    ("matrix", "hint"),
    [
        (np.diag([1e-3, 1e-3, 1e-3, 1.0]), "it stretches by 0.001"),
        (np.diag([-1.0, 1.0, 1.0, 1.0]), "mirrors"),
        (TO_SCAN.T, "last row"),
        (np.eye(3), "16 numbers"),
        (np.full((4, 4), np.nan), "last row"),
    ],
)
def test_what_is_not_rigid_is_refused(
    tmp_path: Path, matrix: np.ndarray, hint: str
) -> None:
    path = tmp_path / "t.txt"
    np.savetxt(path, matrix)
    with pytest.raises(InputError, match=hint):
        read_rigid_transform(path)


def test_other_files_are_refused_in_a_line(tmp_path: Path) -> None:
    for name in ("t.tfm", "t.h5"):
        (tmp_path / name).write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(range(200)))
        with pytest.raises(InputError, match=r"linear transform|crashed"):
            read_rigid_transform(tmp_path / name)
    field = sitk.DisplacementFieldTransform(sitk.Image([4] * 3, sitk.sitkVectorFloat64))
    sitk.WriteTransform(field, str(tmp_path / "field.h5"))
    with pytest.raises(InputError, match="not linear"):
        read_rigid_transform(tmp_path / "field.h5")
    with pytest.raises(InputError, match="no such file"):
        read_rigid_transform(tmp_path / "absent.h5")
    with pytest.raises(InputError, match=r"must be \.txt"):
        read_rigid_transform(tmp_path / "t.xfm")
