import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.geometry.array_checks import (
    checked_indices,
    checked_labels,
    checked_numbers,
    checked_points,
)


@pytest.mark.parametrize(
    "values",
    [
        [0, 3, 2],
        np.array([0, 3, 2], dtype=np.uint8),
        np.array([0, 3, 2], dtype=">i4"),
        np.array([0, 3, 2], dtype=np.longlong),
    ],
)
def test_indices_of_any_integer_type_pass(values) -> None:  # type: ignore[no-untyped-def]
    found = checked_indices(values, 4, "nodes")
    assert found.dtype == np.int64
    assert found.tolist() == [0, 3, 2]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([0.0, 1.0], "integers .got float64"),
        ([0, 4], "index 0…3 .got 0…4"),
        ([-1, 2], "index 0…3 .got -1…2"),
        ([2**32, 1], "index 0…3"),
        ([2**70, 1], "integers .got object"),
        (np.array([2**64 - 1], dtype=np.uint64), "index 0…3"),
        ([True, False, True, True], "mask: use np.flatnonzero"),
        (["0", "1"], "integers"),
        ([[0, 1], [2]], "array of numbers"),
        (np.ma.masked_array([0, 1], [False, True]), "masked"),
        ([1j], "integers .got complex"),
    ],
)
def test_what_is_no_index_is_refused_before_it_is_cast(values, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=f"nodes must .*{message}"):
        checked_indices(values, 4, "nodes")


def test_an_empty_list_of_indices_has_no_type() -> None:
    assert checked_indices([], 4, "nodes").dtype == np.int64
    with pytest.raises(InputError, match=r"\(n_cells, 4\), n_cells ≥ 1"):
        checked_indices(np.empty((0, 4)), 4, "cells", corners=4)


def test_indices_whose_range_is_checked_later_may_be_any_integers() -> None:
    assert checked_indices([7, -1], None, "nodes").tolist() == [7, -1]
    with pytest.raises(InputError, match="integers"):
        checked_indices([0.5], None, "nodes")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[0.0, 0.0, 1j]], "real numbers"),
        ([["a", "b", "c"]], "real numbers"),
        ([[0.0, None, 0.0]], "real numbers"),
        ([[0.0, 1.0]], r"\(n_points, 3\)"),
        ([], r"\(n_points, 3\)"),
        ([[0.0, 1.0, 2.0], [0.0]], "array of numbers"),
        ([[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]], "finite .point 1"),
        ([[0.0, 0.0, -np.inf]], "finite .point 0"),
        ([[0.0, 1e300, 0.0]], "finite .point 0"),
    ],
)
def test_what_is_no_point_is_refused(values, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=message):
        checked_points(values, "points")


def test_numbers_keep_their_shape_and_come_as_a_copy() -> None:
    numbers = np.arange(6.0).reshape(2, 3)
    found = checked_numbers(numbers, "forces")
    found[0, 0] = 9.0
    assert numbers[0, 0] == 0.0
    assert found.shape == (2, 3)
    assert np.isnan(checked_numbers([np.nan], "forces")).all()


@pytest.mark.parametrize(
    "labels", [[0.0, np.nan], [0.0, 0.5], [0, 2**31], [0.0, np.inf], [0], [0, 1j]]
)
def test_labels_must_be_whole(labels: list[complex]) -> None:
    with pytest.raises(InputError, match="region must"):
        checked_labels(np.array(labels), 2, "region")


def test_whole_labels_pass_as_floats_too() -> None:
    assert checked_labels(np.array([0.0, 2.0]), 2, "region").dtype == np.int32
