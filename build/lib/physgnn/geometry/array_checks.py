"""Arrays that come from outside: coordinates, indices of points, labels.

Compiled code reads where an index points to, whatever is there. So no array of indices
is cast before it has been looked at here.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError

LABELS = np.iinfo(np.int32)
# Coordinates beyond it are none in any unit, and their volumes overflow.
LARGEST_COORDINATE = 1e9


def checked_numbers(values: ArrayLike, what: str) -> FloatArray:
    """Return real numbers as float64, in any shape, contiguous; NaN passes.

    Raises
    ------
    InputError
        If they are complex, text, masks or objects, or rows differ in length.
    """
    found = _array(values, what)
    if found.size and found.dtype.kind not in "iuf":
        raise InputError(f"{what} must be real numbers (got {found.dtype})")
    numbers = found.astype(np.float64)
    return np.ascontiguousarray(numbers) if numbers.ndim else numbers


def checked_points(values: ArrayLike, what: str) -> FloatArray:
    """Return coordinates as float64, (n_points, 3), contiguous.

    Parameters
    ----------
    values : array
        Real numbers.
    what : str
        What messages call them, such as ``"points"``.

    Raises
    ------
    InputError
        If there are none, they are not three real numbers each, or one is not finite
        or beyond 10⁹ mm.
    """
    points = checked_numbers(values, what)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise InputError(
            f"{what} must have shape (n_points, 3), n_points ≥ 1 (got {points.shape})"
        )
    usable = np.abs(points) <= LARGEST_COORDINATE  # of NaN too, that is not so
    if not usable.all():
        bad = int(np.flatnonzero(~usable.all(axis=1))[0])
        raise InputError(
            f"{what} must be finite (point {bad} is {points[bad].tolist()})"
        )
    return points


def checked_indices(
    values: ArrayLike, n: int | None, what: str, *, corners: int | None = None
) -> IntArray:
    """Return indices of points as int64: (n_indices,), or rows of corners.

    Parameters
    ----------
    values : array
        Integers; an empty list may be of any type.
    n : int or None
        How many there are to point to; None if that is checked later.
    what : str
        What messages call them; rows of corners in one word, such as ``"cells"``.
    corners : int, optional
        How many a row has; by default all are taken as one list.

    Raises
    ------
    InputError
        If they are not integers, not all in 0…n − 1, or not in one row or more of
        `corners`.
    """
    found = _array(values, what)
    if corners is not None and (
        found.ndim != 2 or found.shape[1] != corners or len(found) == 0
    ):
        raise InputError(
            f"{what} must have shape (n_{what}, {corners}), n_{what} ≥ 1 "
            f"(got {found.shape})"
        )
    if found.size == 0:
        return np.empty(0, dtype=np.int64)
    if found.dtype.kind == "b":
        raise InputError(f"{what} must be indices (got a mask: use np.flatnonzero)")
    if found.dtype.kind not in "iu":
        raise InputError(f"{what} must be integers (got {found.dtype})")
    if n is not None and (found.min() < 0 or found.max() >= n):
        raise InputError(
            f"{what} must index 0…{n - 1} (got {found.min()}…{found.max()})"
        )
    indices = found.astype(np.int64)
    return indices.ravel() if corners is None else indices


def checked_labels(values: ArrayLike, n: int, what: str) -> NDArray[np.int32]:
    """Return one label a cell as int32, (n,); whole numbers may come as floats.

    Raises
    ------
    InputError
        If there is not one for each cell, or one is no whole number of 32 bits.
    """
    found = _array(values, what)
    if found.shape != (n,):
        raise InputError(
            f"{what} must have one label a cell, ({n},) (got {found.shape})"
        )
    if found.dtype.kind not in "biuf":
        raise InputError(f"{what} must be whole numbers (got {found.dtype})")
    # of NaN none of this holds
    whole = (found >= LABELS.min) & (found <= LABELS.max) & (np.floor(found) == found)
    if not whole.all():
        bad = int(np.flatnonzero(~whole)[0])
        raise InputError(
            f"{what} must be whole numbers (that of cell {bad} is {found[bad]})"
        )
    return np.ascontiguousarray(found, dtype=np.int32)


def _array(values: ArrayLike, what: str) -> NDArray[Any]:
    """Return an array; what NumPy can make none of, or only in part, is refused."""
    if np.ma.is_masked(values):
        raise InputError(f"{what} must all be known (some are masked)")
    try:
        return np.asarray(values)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{what} must be an array of numbers ({error})") from error
