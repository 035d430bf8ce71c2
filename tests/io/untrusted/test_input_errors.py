"""What a file makes a parser raise becomes one line; our own mistakes stay."""

import zlib
from pathlib import Path

import pytest

from physgnn.errors import InputError
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import real_numbers, whole_numbers


@pytest.mark.parametrize(
    "error",
    [
        zlib.error("Error -3"), RecursionError("too deep"), OverflowError("too large"),
        KeyError("points"), TypeError("no ufunc"), ZeroDivisionError(), EOFError(),
        MemoryError(), OSError(5, "Input/output error"), UnicodeError("two\nlines"),
    ],
)  # fmt: skip
def test_foreign_errors_name_the_file(error: Exception) -> None:
    caught = pytest.raises(InputError, match=r"^a\.nii: expected an image")
    with caught as found, reading("a.nii", "an image"):
        raise error
    assert "\n" not in str(found.value) and found.value.__cause__ is error


def test_mistakes_of_ours_keep_their_traceback() -> None:
    for error in (AssertionError(), NameError("x"), ModuleNotFoundError("y")):
        with pytest.raises(type(error)), reading("a.nii", "an image"):
            raise error


def test_a_file_is_named_once() -> None:
    path = Path("a.nii")
    with pytest.raises(InputError) as caught, reading(path, "x"), reading(path, "y"):
        raise InputError("it is empty")
    assert str(caught.value) == "a.nii: it is empty"


def test_numbers_that_numpy_would_change() -> None:
    for values in ([1j], ["1"], [None]):
        for check in (real_numbers, whole_numbers):
            with pytest.raises(InputError, match="numbers"):
                check(values, "points")
    for values in ([1.5], [float("nan")], [2**32], [-(2.0**40)], [float("inf")]):
        with pytest.raises(InputError, match="region must"):
            whole_numbers(values, "region")
    assert whole_numbers([2.0, True], "region").tolist() == [2, 1]
    assert whole_numbers([], "region").shape == (0,)
