"""Segmentations of 3D Slicer: names, labels, and layers that overlap."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io.medical.images.formats import (
    read_image,
    read_segmentation,
    write_image,
)

AFFINE = np.diag([-2.0, 2.0, 3.0, 1.0])
BRAIN = np.zeros((8, 9, 10), np.uint8)
BRAIN[1:7, 1:8, 1:9] = 1
TUMOUR = np.zeros_like(BRAIN)
TUMOUR[2:4, 2:4, 2:5] = 1


def header(dimension: int, sizes: str, directions: str, kinds: str) -> str:
    return (
        f"NRRD0004\ntype: unsigned char\ndimension: {dimension}\n"
        f"space: left-posterior-superior\nsizes: {sizes}\n"
        f"space directions: {directions}\nkinds: {kinds}\nencoding: raw\n"
        "space origin: (0,0,0)\n"
    )


def segment(i: int, name: str, label: int, layer: int) -> str:
    return (
        f"Segment{i}_Name:={name}\nSegment{i}_LabelValue:={label}\n"
        f"Segment{i}_Layer:={layer}\nSegment{i}_Color:=0.5 0.7 0.9\n"
    )


def layered(path: Path, more: str) -> Path:
    data = np.stack([BRAIN, 4 * TUMOUR])
    head = header(
        4, "2 8 9 10", "none (2,0,0) (0,-2,0) (0,0,3)", "list domain domain domain"
    )
    path.write_bytes((head + more + "\n").encode() + data.tobytes(order="F"))
    return path


def test_names_come_back_and_itk_finds_them(tmp_path: Path) -> None:
    data = (BRAIN + 6 * TUMOUR).astype(np.int32)
    names = {1: "Brain", 7: "Tumor core"}
    path = tmp_path / "a.seg.nrrd"
    write_image(path, LabelVolume(data, AFFINE, names))
    back = read_segmentation(path)
    np.testing.assert_array_equal(back.data, data)
    assert back.names == names
    image = sitk.ReadImage(str(path))
    assert image.GetMetaData("Segment1_Name") == "Tumor core"
    assert image.GetMetaData("Segment1_LabelValue") == "7"
    with pytest.raises(InputError, match="holds labels"):
        write_image(path, Image(data, AFFINE))


def test_where_layers_overlap_the_smaller_segment_wins(tmp_path: Path) -> None:
    lines: list[str] = []
    more = segment(0, "brain", 1, 0) + segment(1, "tumour", 4, 1)
    path = layered(tmp_path / "a.seg.nrrd", more)
    found = read_segmentation(path, log=lines.append)
    np.testing.assert_array_equal(found.data, np.where(TUMOUR, 2, BRAIN))
    assert found.names == {1: "brain", 2: "tumour"}
    np.testing.assert_allclose(np.diag(found.affine), [-2, 2, 3, 1])
    assert "segments overlap (0.144 ml)" in lines[-1]
    with pytest.raises(InputError, match="segmentation in layers"):
        read_image(path)


def test_earlier_versions_gave_every_segment_a_layer(tmp_path: Path) -> None:
    data = np.stack([BRAIN, TUMOUR])
    head = header(
        4, "2 8 9 10", "none (2,0,0) (0,-2,0) (0,0,3)", "list domain domain domain"
    )
    names = "Segment0_Name:=brain\nSegment1_Name:=tumour\n\n"
    path = tmp_path / "a.seg.nrrd"
    path.write_bytes((head + names).encode() + data.tobytes(order="F"))
    found = read_segmentation(path)
    np.testing.assert_array_equal(found.data, np.where(TUMOUR, 2, BRAIN))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (segment(0, "brain", 1, 5), "layer 5, and there are 2"),
        (segment(0, "a", 1, 0) + segment(1, "b", 1, 0), "two segments have one label"),
        ("", "three axes"),
    ],
)
def test_bad_segments(more: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read_segmentation(layered(tmp_path / "a.seg.nrrd", more))
