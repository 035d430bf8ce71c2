import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.serving.protocol.messages import (
    MAX_BYTES,
    PatchLoad,
    SectionPlane,
    read_message,
    read_patch_load,
)

PATCH_LOAD = {
    "type": "patch_load",
    "id": 7,
    "point": [1, 2.5, 3],
    "force_n": [0, 0, -0.5],
    "radius_mm": 12,
    "predictors": ["linear"],
}


def test_a_patch_load_is_read() -> None:
    patch_load = read_patch_load(json.dumps(PATCH_LOAD))
    assert patch_load == PatchLoad(
        id=7,
        point=(1.0, 2.5, 3.0),
        force_n=(0.0, 0.0, -0.5),
        radius_mm=12.0,
        predictors=["linear"],
    )


def test_a_section_is_read_and_taken_away() -> None:
    text = '{"type": "section", "axis": "axial", "offset_mm": 3}'
    assert read_message(text) == SectionPlane(axis="axial", offset_mm=3.0)
    away = read_message('{"type": "section", "axis": null}')
    assert isinstance(away, SectionPlane)
    assert away.axis is None


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"type": "pull"}, "'pull'"),
        ({"point": [1, 2]}, "point"),
        ({"point": [1, 2, "3"]}, "point.2"),
        ({"point": [1, 2, float("nan")]}, "finite"),
        ({"force_n": [0, 0, 0]}, "longer than 0"),
        ({"force_n": [0, 0, 1e6]}, "at most 1000 N"),
        ({"radius_mm": 0}, "greater than 0"),
        ({"radius_mm": 1e9}, "less than or equal"),
        ({"predictors": []}, "at least 1"),
        ({"predictors": ["oracle"]}, "'network'"),
        ({"id": -1}, "id"),
        ({"colour": "red"}, "colour"),
        ({"field": "oracle"}, "field: Input should be 'displacement' or 'error'"),
    ],
)
def test_a_wrong_patch_load_is_one_line_that_says_what_is_wrong(change, says) -> None:
    with pytest.raises(InputError) as error:
        read_message(json.dumps({**PATCH_LOAD, **change}))
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_an_axis_that_is_none_names_those_there_are() -> None:
    with pytest.raises(
        InputError, match="axis: Input should be 'sagittal' or 'coronal'"
    ):
        read_message('{"type": "section", "axis": "oblique"}')


def test_too_long_and_binary_messages_are_refused_before_they_are_parsed() -> None:
    with pytest.raises(InputError, match="at most 4096 characters"):
        read_message("[" * (MAX_BYTES + 1))
    with pytest.raises(InputError, match="got binary"):
        read_message(b"\x00")
    with pytest.raises(InputError, match="a patch load is wanted"):
        read_patch_load('{"type": "release"}')


@given(st.one_of(st.text(), st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
).map(json.dumps)))  # fmt: skip
def test_nothing_but_an_input_error_comes_of_nonsense(content: str) -> None:
    with pytest.raises(InputError):
        read_message(content)
