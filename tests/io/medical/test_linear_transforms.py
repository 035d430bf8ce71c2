from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.io.medical import linear_transforms
from physgnn.io.medical.linear_transforms import read_rigid_transform, transformed
from physgnn.io.medical.transform_parts import LINEAR

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
        with pytest.raises(InputError, match=r"first line|no linear transform|crashed"):
            read_rigid_transform(tmp_path / name)
    field = sitk.DisplacementFieldTransform(sitk.Image([4] * 3, sitk.sitkVectorFloat64))
    sitk.WriteTransform(field, str(tmp_path / "field.h5"))
    with pytest.raises(InputError, match="must be linear"):
        read_rigid_transform(tmp_path / "field.h5")
    with pytest.raises(InputError, match="no such file"):
        read_rigid_transform(tmp_path / "absent.h5")
    with pytest.raises(InputError, match=r"must be \.txt"):
        read_rigid_transform(tmp_path / "t.xfm")


HEAD = "#Insight Transform File V1.0\n#Transform 0\n"
AFFINE = "Transform: AffineTransform_double_3_3\nParameters: 1 0 0 0 1 0 0 0 1 5 6 7\n"
FIXED = "FixedParameters: 0 0 0\n"


def test_parts_of_a_composite_are_one_transform(tmp_path: Path) -> None:
    shift = sitk.TranslationTransform(3, (1.0, 2.0, 3.0))
    both = sitk.CompositeTransform([shift, sitk.Euler3DTransform()])
    for name in ("t.tfm", "t.h5"):
        sitk.WriteTransform(both, str(tmp_path / name))
        matrix = read_rigid_transform(tmp_path / name)
        np.testing.assert_allclose(matrix[:3, 3], [1.0, 2.0, -3.0])


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (HEAD + AFFINE, "no line 'FixedParameters"),
        (HEAD + AFFINE[:-3] + "\n" + FIXED, "got 11"),
        (HEAD + AFFINE[:40] + "\n", "no line 'Parameters"),
        (HEAD + AFFINE.replace("7", "7 8") + FIXED, "got 13"),
        (HEAD + AFFINE + "FixedParameters: 0 0\n", "3 fixed parameters \\(got 2"),
        (HEAD + AFFINE.replace("5 6", "5,5 6") + FIXED, "5,5"),
        (HEAD + 2 * (AFFINE + FIXED), "one transform .got 2"),
        (HEAD, "no line 'Transform"),
        (HEAD + AFFINE + FIXED[:-1], "ends inside a line"),
        (HEAD + "Transform: CompositeTransform_double_3_3\n", "has no parts"),
        (
            HEAD + "Transform: VersorRigid3DTransform_double_3_3\n"
            "Parameters: 0 0 0.1 5 6\n" + FIXED,
            "6 parameters .got 5",
        ),
        (
            HEAD + "Transform: BSplineTransform_double_3_3\nParameters: 0\n" + FIXED,
            "linear in three dimensions .got BSpline",
        ),
    ],
)
def test_a_cut_file_of_itk_is_no_identity(tmp_path: Path, text: str, hint: str) -> None:
    """ITK takes what is left of it, goes on in memory not its own, or the first."""
    path = tmp_path / "t.tfm"
    path.write_text(text)
    with pytest.raises(InputError, match=hint):
        read_rigid_transform(path)


def test_every_linear_transform_has_the_numbers_that_itk_gives_it() -> None:
    for name, sizes in LINEAR.items():
        if not hasattr(sitk, name):
            continue
        made = getattr(sitk, name)
        has_dimension = name in ("AffineTransform", "TranslationTransform")
        one = made(3) if has_dimension or name == "ScaleTransform" else made()
        assert len(one.GetParameters()) == sizes.parameters
        assert len(one.GetFixedParameters()) in sizes.fixed


def test_the_first_of_several_is_not_taken_unsaid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """HDF5 has no text to look at beforehand: SimpleITK's own warning tells."""
    monkeypatch.setattr(linear_transforms, "check_transform_text", lambda _: None)
    (tmp_path / "t.tfm").write_text(HEAD + 2 * (AFFINE + FIXED))
    with pytest.raises(InputError, match="must hold one transform"):
        read_rigid_transform(tmp_path / "t.tfm")
