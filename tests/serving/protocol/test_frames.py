import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.serving.protocol.frames import decode, encode

SHAPES = st.lists(st.integers(0, 5), min_size=1, max_size=3)


@given(
    st.dictionaries(
        st.text(max_size=5),
        st.tuples(SHAPES, st.sampled_from([np.float64, np.int64, np.uint8])),
        max_size=4,
    ),
    st.dictionaries(
        st.text(max_size=8).filter(lambda key: key != "arrays"),
        st.one_of(st.text(max_size=9), st.integers(), st.none()),
    ),
)
def test_what_is_encoded_is_decoded(described, header) -> None:
    arrays = {
        name: np.arange(np.prod(shape)).reshape(shape).astype(kind)
        for name, (shape, kind) in described.items()
    }
    read, values = decode(encode(header, arrays))
    assert read == header
    assert list(values) == list(arrays)
    for name, array in arrays.items():
        np.testing.assert_array_equal(values[name], array)


def test_arrays_start_on_multiples_of_four_as_typed_arrays_need() -> None:
    message = encode({"é": "ü"}, {"a": np.zeros(3, np.uint8), "b": np.ones(1)})
    length = int.from_bytes(message[4:8], "little")
    assert length % 4 == 0
    assert "é" in json.loads(message[8 : 8 + length])
    assert len(message) == 8 + length + 4 + 4


def test_a_number_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="JSON"):
        encode({"value": float("nan")})


def test_something_else_is_no_frame() -> None:
    with pytest.raises(InputError, match="a frame starts with"):
        decode(b"RIFF1234")
