"""Every label of a map is used, known to lie outside, or said to be left out."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.regions import REGIONS
from physgnn.geometry.segmentation.label_report import (
    check_all_used,
    check_is_segmentation,
    label_lines,
    label_volumes,
    not_there,
)
from physgnn.geometry.segmentation.labels.label_tables import (
    LABEL_TABLES,
    label_table,
    resolved,
)


def test_two_percent_may_be_left_out() -> None:
    table = label_table("brain=1,tumour=4")
    assert check_all_used({1: 990.0, 3: 15.0}, table) == ["not used: 3 (15 ml)"]
    with pytest.raises(InputError, match=r"not used: 3 \(30 ml\), 3% .*brain=1\+3"):
        check_all_used({1: 970.0, 3: 30.0}, table)
    lines = check_all_used({1: 970.0, 3: 30.0}, table, ignore_labels=True)
    assert lines == ["not used: 3 (30 ml)"]
    with pytest.raises(InputError, match=r"not used: -2, 3 .*give -2 a number above 0"):
        check_all_used({-2: 30.0, 1: 970.0, 3: 1.0}, table)
    assert not_there({1: 970.0}, table) == ["asked for, not there: tumour=4"]


def test_what_is_known_to_lie_outside_counts_as_used() -> None:
    table = LABEL_TABLES["freesurfer"]
    (line,) = check_all_used({2: 500.0, 24: 300.0, 507: 900.0}, table)
    assert line == "outside of the brain: 24, 507 (1.2e+03 ml)"


def test_freesurfer_lesions_are_no_tumours_and_all_parcels_are_brain() -> None:
    table = LABEL_TABLES["freesurfer"]
    assert "tumour" not in table.labels
    for label in (25, 57, 1035, 3005, 4035, 11105, 12175, 14101, 5001):
        assert table.tissue(label) == "brain"


@pytest.mark.parametrize(
    ("present", "name"),
    [
        ((1, 2, 4), "brats-2020"),
        ((1, 2, 3), "brats-2023"),
        ((1, 2, 3, 4), "brats-post"),
        ((1, 2), "brats-2020"),
    ],
)
def test_the_numbering_of_brats(present: tuple[int, ...], name: str) -> None:
    found, (line,) = resolved("brats", present)
    assert found == name and name in line and "enhancing" in line
    assert resolved("msd", present) == ("msd", [])


def test_the_resection_cavity_is_no_tumour() -> None:
    assert LABEL_TABLES["brats-post"].tissue(4) == "ventricle"
    assert LABEL_TABLES["brats-2020"].tissue(4) == "tumour"
    assert LABEL_TABLES["msd"].tissue(1) == "brain"


def test_grey_values_are_no_labels() -> None:
    x = np.indices((20, 20, 20)).sum(axis=0)
    check_is_segmentation(LabelVolume(x // 2 * 0 + np.arange(20)[:, None] // 1, EYE))
    many = np.repeat(np.arange(1, 41), 10).reshape(40, 10)[:, :, None]
    check_is_segmentation(LabelVolume(np.broadcast_to(many, (40, 10, 4)).T, EYE))
    noise = np.random.default_rng(0).integers(0, 1000, (20, 20, 20))
    with pytest.raises(InputError, match=r"image, not a segmentation.*physgnn segment"):
        check_is_segmentation(LabelVolume(noise, EYE))
    for values in (noise + 0.5, noise * 1e9, np.where(noise > 5, np.nan, 1.0)):
        with pytest.raises(InputError, match="image, not a segmentation"):
            LabelVolume(values, EYE)


EYE = np.eye(4)


def test_a_line_a_label_with_the_dice_of_its_tissue() -> None:
    data = np.zeros((10, 10, 10), np.int32)
    data[2:8] = 1
    data[2:4] = 3
    data[7:8] = 9
    labels = LabelVolume(data, np.diag([10.0, 10.0, 10.0, 1.0]))
    assert label_volumes(labels) == {1: 300.0, 3: 200.0, 9: 100.0}
    regions = np.full(data.shape, -1, np.int32)
    regions[2:8] = 0
    regions[3:4] = 1
    lines = label_lines(labels, label_table("brain=1+9,tumour=3"), regions, REGIONS)
    assert lines == [
        "label 1 → brain: 300 ml; Dice of brain with the mesh 0.889",
        "label 3 → tumour: 200 ml; Dice of tumour with the mesh 0.667",
        "label 9 → brain: 100 ml; Dice of brain with the mesh 0.889",
    ]


def test_labels_of_segment_are_known_and_those_of_a_tumour_are_not_taken_for_them() -> (
    None
):
    assert resolved("mask", {1: 1400.0, 2: 10.0, 3: 25.0})[0] == "segment"
    for other in (
        {1: 1400.0},  # a mask
        {1: 20.0, 2: 60.0, 3: 10.0},  # BraTS
        {1: 120.0, 2: 5.0, 3: 10.0},  # a decathlon's: much oedema
        {1: 300.0, 2: 700.0, 3: 500.0},  # fluid, grey, white
        {1: 1400.0, 7: 10.0},
    ):
        assert resolved("mask", other) == ("mask", [])
