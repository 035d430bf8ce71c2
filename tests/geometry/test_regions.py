from hypothesis import given
from hypothesis import strategies as st

from physgnn.geometry import regions
from physgnn.geometry.regions import REGIONS, region_label, region_name


def test_labels_and_names_are_in_one_order() -> None:
    labels = (regions.BRAIN, regions.TUMOUR, regions.VENTRICLE)
    assert (
        tuple(map(region_name, labels)) == REGIONS == ("brain", "tumour", "ventricle")
    )


@given(st.integers(0, 10_000))
def test_every_label_is_found_by_its_digits_and_named_ones_by_their_name(
    label: int,
) -> None:
    assert region_label(str(label)) == label
    named = region_label(region_name(label))
    assert named == (label if label < len(REGIONS) else None)


@given(st.text().filter(lambda text: text not in REGIONS and not text.isdecimal()))
def test_anything_else_is_no_region(name: str) -> None:
    assert region_label(name) is None
