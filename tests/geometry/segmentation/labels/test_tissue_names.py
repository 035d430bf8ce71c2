"""Names that people give to segments, and what they stand for."""

import pytest

from physgnn.errors import InputError
from physgnn.geometry.segmentation.labels.tissue_names import tissue_of, tissues_by_name

NAMES = {1: "Brain", 3: "Tumor core", 4: "left lateral ventricle", 5: "Segment_5"}


@pytest.mark.parametrize(
    ("name", "tissue"),
    [
        ("brain", "brain"), ("Brain-stem", "brain"), ("cerebellum", "brain"),
        ("TUMOUR", "tumour"), ("tumor", "tumour"), ("brain tumour", "tumour"),
        ("Ventricles", "ventricle"), ("Segment_1", None), ("skull", None), ("", None),
    ],
)  # fmt: skip
def test_words(name: str, tissue: str | None) -> None:
    assert tissue_of(name) == tissue


def test_names_decide_unless_the_user_does() -> None:
    by_name = {"brain": (1,), "tumour": (3,), "ventricle": (4,)}
    assert tissues_by_name("mask", [1, 3, 4, 5], NAMES) == by_name
    assert tissues_by_name("mask", [8], {8: "anything"}) == {"brain": (8,)}
    spelled = tissues_by_name("brain=brain+segment_5,tumour=3", [1, 3, 5], NAMES)
    assert spelled == {"brain": (1, 5), "tumour": (3,)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mask", r"called brain \(it has 3 'Tumor core', 5 'Segment_5'\).*--labels"),
        ("brain=skull", "nothing is called 'skull'"),
        ("tumour=3", "one must be the brain"),
        ("brain=3,tumour=Tumor core", "each belong to one"),
        ("freesurfer", "labels must be such as"),
        ("brain=1,brain=3", "each tissue once"),
    ],
)
def test_what_cannot_be_meant(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        tissues_by_name(text, [3, 5], NAMES)
