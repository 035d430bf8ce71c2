"""Every format gives the same voxels in the same place, as ITK and nibabel have it."""

from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import SimpleITK as sitk

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.imaging.transforms import from_itk, to_itk
from physgnn.io.medical.images.formats import (
    IMAGE_FORMATS,
    WRITTEN,
    named_like,
    read_image,
    read_segmentation,
    write_image,
)


def turned(angle_deg: float, sizes: list[float], *, mirrored: bool) -> np.ndarray:
    a, b = np.radians([angle_deg, angle_deg / 3])
    about_x = np.array(
        [[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]
    )
    about_z = np.array(
        [[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]]
    )
    affine = np.eye(4)
    affine[:3, :3] = about_z @ about_x @ np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])
    affine[:3, :3] *= sizes
    affine[:3, 3] = [12.5, -30.25, 7.125]
    return affine


AFFINES = {
    "plain": np.diag([1.0, 1.0, 1.0, 1.0]),
    "oblique": turned(25.0, [1.0, 1.0, 1.0], mirrored=False),
    "anisotropic": turned(-40.0, [0.5, 0.9, 5.5], mirrored=False),
    "mirrored": turned(25.0, [0.8, 1.2, 2.0], mirrored=True),
}
DATA = np.random.default_rng(0).integers(-500, 3000, size=(5, 6, 7)).astype(np.int16)
BY_ITK = [".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".hdr"]


@pytest.mark.parametrize("suffix", WRITTEN)
@pytest.mark.parametrize("name", AFFINES)
def test_round_trip(suffix: str, name: str, tmp_path: Path) -> None:
    path, affine = tmp_path / f"t1{suffix}", AFFINES[name]
    if suffix != ".seg.nrrd":
        write_image(path, Image(DATA.astype(np.float64) / 3, affine))
        back = read_image(path)
        np.testing.assert_array_equal(back.data, (DATA / 3).astype(np.float32))
        np.testing.assert_allclose(back.affine, affine, atol=2e-5)
    labels = LabelVolume((DATA > 0).astype(np.int32) * 70_000, affine)
    write_image(path, labels)
    seen = read_segmentation(path)
    np.testing.assert_array_equal(seen.data, labels.data)
    np.testing.assert_allclose(seen.affine, affine, atol=2e-5)


@pytest.mark.parametrize("suffix", BY_ITK)
@pytest.mark.parametrize("name", AFFINES)
def test_as_itk_writes_it(suffix: str, name: str, tmp_path: Path) -> None:
    if suffix == ".hdr" and name != "plain":
        pytest.skip("Analyze has no directions")
    path, image = tmp_path / f"t1{suffix}", to_itk(Image(DATA, AFFINES[name]))
    for compressed in (False, True):
        sitk.WriteImage(image, str(path), useCompression=compressed)
        back, seen = read_image(path), from_itk(sitk.ReadImage(str(path)))
        np.testing.assert_array_equal(back.data, DATA)
        np.testing.assert_allclose(back.affine, seen.affine, atol=1e-5)


@pytest.mark.parametrize("suffix", [s for s in WRITTEN if ".mg" not in s])
@pytest.mark.parametrize("name", AFFINES)
def test_itk_reads_what_is_written(suffix: str, name: str, tmp_path: Path) -> None:
    path = tmp_path / f"t1{suffix}"
    labels = LabelVolume((DATA > 0).astype(np.int32), AFFINES[name])
    write_image(path, labels, note="ok")
    back = from_itk(sitk.ReadImage(str(path)))
    np.testing.assert_array_equal(back.data, labels.data)
    np.testing.assert_allclose(back.affine, labels.affine, atol=1e-5)


@pytest.mark.parametrize("suffix", [".mgh", ".mgz"])
def test_nibabel_and_freesurfer_agree(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"t1{suffix}"
    nib.save(nib.MGHImage(DATA.astype(np.float32), AFFINES["oblique"]), path)
    back = read_image(path)
    np.testing.assert_array_equal(back.data, DATA)
    np.testing.assert_allclose(back.affine, AFFINES["oblique"], atol=1e-5)


@pytest.mark.parametrize(
    "dtype", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]
)
@pytest.mark.parametrize("suffix", [".nrrd", ".mha"])
def test_every_type_of_numbers(dtype: str, suffix: str, tmp_path: Path) -> None:
    path, data = tmp_path / f"t1{suffix}", (DATA % 100).astype(dtype)
    sitk.WriteImage(to_itk(Image(data, np.eye(4))), str(path))
    back = read_image(path).data
    np.testing.assert_array_equal(back, data)
    assert back.dtype == data.dtype


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii", ".mhd"])
def test_colours_and_series_are_refused(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"x{suffix}"
    rgb = sitk.GetImageFromArray(np.zeros((4, 5, 6, 3), np.uint8), isVector=True)
    sitk.WriteImage(rgb, str(path))
    with pytest.raises(InputError, match=r"one real number a voxel|three axes"):
        read_image(path)
    several = sitk.GetImageFromArray(np.zeros((9, 4, 5, 6), np.int16), isVector=False)
    sitk.WriteImage(several, str(path))
    with pytest.raises(InputError, match="series of 9 volumes"):
        read_image(path)
    sitk.WriteImage(sitk.GetImageFromArray(np.ones((4, 5), np.int16)), str(path))
    with pytest.raises(InputError, match=r"three axes .*\(5, 4\).*not a slice"):
        read_image(path)


@pytest.mark.parametrize("suffix", [".nrrd", ".mha"])
@pytest.mark.parametrize("compressed", [False, True])
def test_cut_off_files_are_refused(
    suffix: str, compressed: bool, tmp_path: Path
) -> None:
    path = tmp_path / f"t1{suffix}"
    sitk.WriteImage(
        to_itk(Image(DATA, np.eye(4))), str(path), useCompression=compressed
    )
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(InputError, match=r"t1\.\w+: .*(cut off|cannot be read)"):
        read_image(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("sizes: 5 6 7", "sizes: 500000 600000 7", "would take .* GB"),
        ("sizes: 5 6 7", "sizes: 5 6", "as many as its dimension"),
        ("sizes: 5 6 7", "sizes: 5 6 0", "must have voxels"),
        ("type: int16", "type: block", "real numbers"),
        ("encoding: gzip", "encoding: hex", "raw or gzip"),
        ("encoding: gzip", "encoding: gzip\ndata file: ../../x.raw", "own folder"),
        ("encoding: gzip", "encoding: gzip\ndata file: LIST", "several files"),
        ("encoding: gzip", "encoding: gzip\ndata file: absent.gz", "is not there"),
        ("kinds:", 'space units: "furlong" "furlong" "furlong"\nkinds:', "in mm"),
        ("kinds:", 'space units: "mm" "m" "mm"\nkinds:', "one unit"),
        ("(0.0,0.0,1.0)", "(0.0,0.5,1.0)", "right angles"),
        ("(0.0,0.0,1.0)", "none", "three axes"),
    ],
)
def test_bad_headers_of_nrrd(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "t1.nrrd"
    write_image(path, Image(DATA, np.eye(4)))
    content = path.read_bytes()
    assert old.encode() in content
    path.write_bytes(content.replace(old.encode(), new.encode(), 1))
    with pytest.raises(InputError, match=message):
        read_image(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("DimSize = 5 6 7", "DimSize = 500000 600000 7", "would take .* GB"),
        ("DimSize = 5 6 7", "DimSize = 5 6", "as many numbers"),
        ("DimSize = 5 6 7", "DimSize = 5 6 8", "declares 480 bytes"),
        ("MET_SHORT", "MET_STRING", "real numbers"),
        ("ElementSpacing = 1.0 1.0 1.0", "ElementSpacing = 1.0", "3 numbers"),
        ("= LOCAL", "= LIST", "several files"),
        ("= LOCAL", "= ../../t.raw", "own folder"),
        ("BinaryData = True", "BinaryData = False", "binary data"),
        ("NDims = 3", "NDims = x", "cannot be read"),
    ],
)
def test_bad_headers_of_metaimage(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "t1.mha"
    write_image(path, Image(DATA, np.eye(4)))
    path.write_bytes(path.read_bytes().replace(old.encode(), new.encode(), 1))
    with pytest.raises(InputError, match=message):
        read_image(path)


def test_units_and_axes_that_a_header_states(tmp_path: Path) -> None:
    path, lines = tmp_path / "t1.nrrd", []
    write_image(path, Image(DATA, AFFINES["oblique"]))
    content = path.read_bytes()
    metres = content.replace(b"kinds:", b'space units: "cm" "cm" "cm"\nkinds:')
    path.write_bytes(metres)
    expected = AFFINES["oblique"].copy()
    expected[:3] *= 10.0
    back = read_image(path, log=lines.append)
    np.testing.assert_allclose(back.affine, expected, atol=1e-9)
    assert any("converted to mm" in line for line in lines)
    path.write_bytes(
        content.replace(b"left-posterior-superior", b"right-anterior-superior")
    )
    flipped = np.diag([-1.0, -1.0, 1.0, 1.0]) @ AFFINES["oblique"]
    np.testing.assert_allclose(read_image(path).affine, flipped, atol=1e-9)
    path.write_bytes(content.replace(b"space: left-posterior-superior\n", b""))
    read_image(path, log=lines.append)
    assert "does not say which axes" in lines[-1]


def test_a_result_takes_the_format_of_its_image() -> None:
    assert named_like("out.mha", "t1.nrrd") == Path("out.mha")
    assert named_like("a/out", "t1.seg.nrrd") == Path("a/out.seg.nrrd")
    assert named_like("out", "T1.MGZ") == Path("out.mgz")
    assert named_like("out", "dicom_folder") == Path("out.nii.gz")
    assert named_like("out", "t1.seg.nrrd", labels=False) == Path("out.nrrd")
    with pytest.raises(InputError, match="holds labels"):
        named_like("out.seg.nrrd", "t1.nrrd", labels=False)


def test_unknown_names_say_what_there_is(tmp_path: Path) -> None:
    (tmp_path / "t1.jpg").write_bytes(b"x")
    with pytest.raises(InputError, match=r"expected an image, \.nii\.gz"):
        read_image(tmp_path / "t1.jpg")
    with pytest.raises(InputError, match="no such file"):
        read_image(tmp_path / "absent.mha")
    for suffix, form in IMAGE_FORMATS.items():
        if form.write is None:
            with pytest.raises(InputError, match="an image is written as"):
                write_image(tmp_path / f"t1{suffix}", Image(DATA, np.eye(4)))
    with pytest.raises(InputError, match="only a folder of DICOM has series"):
        write_image(tmp_path / "t1.mha", Image(DATA, np.eye(4)))
        read_image(tmp_path / "t1.mha", series="1.2.3")
