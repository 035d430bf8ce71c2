"""Units and places that headers state, twice or not at all."""

from pathlib import Path

import nibabel as nib
import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.io.medical.images.formats import read_image

AFFINE = np.diag([-2.0, 2.0, 3.0, 1.0])
AFFINE[:3, 3] = 30, -20, 10
DATA = np.arange(7 * 8 * 9, dtype=np.float32).reshape(7, 8, 9)


def saved(path: Path, sform: float | None, qform: float | None) -> Path:
    """Write with places moved along x by so many mm, or without."""
    image = nib.Nifti1Image(DATA, AFFINE)
    for name, shift in (("sform", sform), ("qform", qform)):
        affine = AFFINE.copy()
        affine[0, 3] += shift or 0.0
        getattr(image, f"set_{name}")(affine, code=0 if shift is None else 1)
    nib.save(image, path)
    return path


@pytest.mark.parametrize(("unit", "mm"), [("meter", 1000.0), ("micron", 0.001)])
def test_other_units_become_mm(unit: str, mm: float, tmp_path: Path) -> None:
    affine = AFFINE.copy()
    affine[:3] /= mm
    image = nib.Nifti1Image(DATA, affine)
    image.header.set_xyzt_units(unit)
    nib.save(image, tmp_path / "a.nii")
    said: list[str] = []
    found = read_image(tmp_path / "a.nii", log=said.append)
    np.testing.assert_allclose(found.affine, AFFINE, rtol=1e-5)
    assert len(said) == 1 and "converted to mm" in said[0]


def test_a_unit_that_cannot_be(tmp_path: Path) -> None:
    image = nib.Nifti1Image(DATA, AFFINE)  # two metres wide voxels, by its header
    image.header.set_xyzt_units("meter")
    nib.save(image, tmp_path / "a.nii")
    with pytest.raises(InputError, match=r"a\.nii: coordinates must be in mm"):
        read_image(tmp_path / "a.nii")


def test_places_that_agree_or_are_alone(tmp_path: Path) -> None:
    for sform, qform in ((0.0, 0.0), (0.0, None), (None, 0.0), (0.0, 1.5)):
        said: list[str] = []
        path = saved(tmp_path / "a.nii", sform, qform)
        found = read_image(path, log=said.append)
        np.testing.assert_allclose(found.affine, AFFINE, atol=1e-5)
        assert len(said) == (qform == 1.5)


def test_places_that_disagree_need_a_word(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.nii", 0.0, 27.0)
    with pytest.raises(InputError, match=r"27\.0 mm apart .* --affine"):
        read_image(path)
    for form, shift in (("sform", 0.0), ("qform", 27.0)):
        found = read_image(path, affine=form)
        np.testing.assert_allclose(found.affine[0, 3], 30 + shift, atol=1e-5)
    only = saved(tmp_path / "b.nii", 0.0, None)
    with pytest.raises(InputError, match="sets no qform"):
        read_image(only, affine="qform")
    with pytest.raises(InputError, match="sform or qform"):
        read_image(only, affine="both")


def test_no_place_at_all_is_said(tmp_path: Path) -> None:
    said: list[str] = []
    found = read_image(saved(tmp_path / "a.nii", None, None), log=said.append)
    middle = found.grid.to_world((np.array(DATA.shape) - 1)[None] / 2)
    np.testing.assert_allclose(middle, 0.0, atol=1e-5)
    assert len(said) == 1 and "neither sform nor qform" in said[0]


@pytest.mark.parametrize(
    ("kind", "what"),
    [
        (np.dtype([("R", "u1"), ("G", "u1"), ("B", "u1")]), "a colour image"),
        (np.dtype(np.complex64), "a complex64 image"),
    ],
)
def test_voxels_that_are_no_real_number(
    kind: np.dtype, what: str, tmp_path: Path
) -> None:
    nib.save(nib.Nifti1Image(np.ones((3, 3, 3), kind), AFFINE), tmp_path / "a.nii")
    with pytest.raises(InputError, match=what):
        read_image(tmp_path / "a.nii")


def test_big_endian_voxels_become_native(tmp_path: Path) -> None:
    header = nib.Nifti1Header(endianness=">")
    nib.save(nib.Nifti1Image(DATA.astype(">f4"), AFFINE, header), tmp_path / "a.nii")
    found = read_image(tmp_path / "a.nii")
    np.testing.assert_array_equal(found.data, DATA)
    assert found.data.dtype.isnative
