"""A folder of DICOM is one series, whole and upright, or a line says why not."""

from pathlib import Path

import numpy as np
import pytest

from dicom_files import SHAPE, write_series
from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io.medical.images.formats import read_image

AFFINE = np.array(
    [[-0.9, 0, 0, 40.0], [0, 0.72, -1.2, -20], [0, 0.54, 1.6, 5], [0, 0, 0, 1]]
)
IMAGE = Image(np.random.default_rng(0).integers(0, 900, size=SHAPE), AFFINE)


def same(found: Image) -> None:
    """By value at a place: slices may be sorted either way."""
    where = IMAGE.grid.to_world(np.indices(SHAPE).reshape(3, -1).T)
    index = np.rint(found.grid.to_index(where)).astype(int)
    np.testing.assert_allclose(found.grid.to_world(index), where, atol=1e-3)
    np.testing.assert_array_equal(found.data[tuple(index.T)], IMAGE.data.ravel())


def test_a_series(tmp_path: Path) -> None:
    files, lines = write_series(tmp_path / "scan", IMAGE), []
    same(read_image(tmp_path / "scan", log=lines.append))
    assert "7 slices, 'T1 MPRAGE'" in lines[-1]
    same(read_image(files[3]))
    without_suffix = files[3].rename(files[3].with_suffix(""))
    same(read_image(without_suffix))


def test_two_series_are_named_and_one_picked(tmp_path: Path) -> None:
    folder = tmp_path / "scan"
    other = Image(IMAGE.data[:, :, :4], IMAGE.affine)
    write_series(folder, IMAGE, uid="1.2.3.1")
    write_series(folder, other, uid="1.2.3.2", description="FLAIR", prefix="F")
    with pytest.raises(
        InputError,
        match=r"holds 2: .*1\.2\.3\.1 \(7 slices, 'T1 MPRAGE'\).*"
        r"1\.2\.3\.2 \(4 slices, 'FLAIR'\).*--series",
    ):
        read_image(folder)
    same(read_image(folder, series="1.2.3.1"))
    same(read_image(folder / "1.2.3.1"))
    assert read_image(folder, series="1.2.3.2").data.shape == (5, 6, 4)
    with pytest.raises(InputError, match=r"no series '1\.2\.3\.7' \(it holds"):
        read_image(folder / "1.2.3.7")


def test_a_missing_slice_is_named(tmp_path: Path) -> None:
    files = write_series(tmp_path / "scan", IMAGE)
    files[3].unlink()
    with pytest.raises(
        InputError, match=r"IM004\.dcm and IM002\.dcm are 4\.00 mm, elsewhere 2\.00 mm"
    ):
        read_image(tmp_path / "scan")


def test_a_tilted_gantry_is_refused(tmp_path: Path) -> None:
    write_series(tmp_path / "scan", IMAGE, shift=np.array([0.5, 0.0, 0.0]))
    with pytest.raises(InputError, match="gantry was tilted by 14°"):
        read_image(tmp_path / "scan")


def test_two_images_in_one_place_are_refused(tmp_path: Path) -> None:
    write_series(tmp_path / "scan", IMAGE, uid="1.2.3")
    write_series(tmp_path / "scan", IMAGE, uid="1.2.3", prefix="again")
    with pytest.raises(InputError, match="place of its own"):
        read_image(tmp_path / "scan")


def test_slices_cut_short_or_alone_are_refused(tmp_path: Path) -> None:
    files = write_series(tmp_path / "scan", IMAGE)
    files[2].write_bytes(files[2].read_bytes()[:-30])
    with pytest.raises(InputError, match="scan"):
        read_image(tmp_path / "scan")
    for file in files[1:]:
        file.unlink()
    with pytest.raises(InputError, match="two slices or more"):
        read_image(tmp_path / "scan")


def test_folders_without_dicom(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder of DICOM files"):
        read_image(tmp_path)
    write_series(tmp_path / "scan", IMAGE)
    with pytest.raises(InputError, match="sub-folders may: name one"):
        read_image(tmp_path)
    with pytest.raises(InputError, match="no such file"):
        read_image(tmp_path / "absent")


def without(file: Path, group: int, element: int) -> None:
    """Remove an element from a file of implicit value representations."""
    content = file.read_bytes()
    start = content.index(
        group.to_bytes(2, "little") + element.to_bytes(2, "little"), 300
    )
    n = int.from_bytes(content[start + 4 : start + 8], "little")
    file.write_bytes(content[:start] + content[start + 8 + n :])


def test_a_damaged_slice_at_an_end_is_named(tmp_path: Path) -> None:
    files = write_series(tmp_path / "scan", IMAGE)
    whole = files[-1].read_bytes()
    for content in (whole[:500], whole[:100], b""):
        files[-1].write_bytes(content)
        with pytest.raises(InputError, match=r"readable \(IM006\.dcm.*whole series"):
            read_image(tmp_path / "scan")
    files[-1].write_bytes(whole)
    (tmp_path / "scan/notes.txt").write_text("of the ward")
    lines: list[str] = []
    same(read_image(tmp_path / "scan", log=lines.append))
    assert "left out, no DICOM images: notes.txt" in lines[0]


def test_the_size_of_pixels_is_said_and_one(tmp_path: Path) -> None:
    files = write_series(tmp_path / "scan", IMAGE)
    content = files[2].read_bytes()
    assert content.count(b".9\\.9 ") == 1
    files[2].write_bytes(content.replace(b".9\\.9 ", b".8\\.8 "))
    with pytest.raises(InputError, match=r"one size of pixels .*IM002\.dcm has 0\.8"):
        read_image(tmp_path / "scan")
    without(files[2], 0x28, 0x30)
    with pytest.raises(InputError, match=r"IM002\.dcm must say its pixel spacing"):
        read_image(tmp_path / "scan")


def test_numbers_of_slices_that_begin_late_or_have_gaps_are_warned_of(
    tmp_path: Path,
) -> None:
    files = write_series(tmp_path / "scan", IMAGE)
    for step, numbers in ((2, "1 to 7"), (4, "1 to 5")):
        for file in files:
            if file.exists() and (files.index(file)) % step:
                file.unlink()
        lines: list[str] = []
        read_image(tmp_path / "scan", log=lines.append)
        assert f"numbered {numbers}" in lines[-1]
