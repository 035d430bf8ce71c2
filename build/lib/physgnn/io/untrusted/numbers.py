"""Numbers from strangers, checked before NumPy casts them.

NumPy drops the imaginary part, cuts 1.5 to 1 and wraps 2³² to 0 without an error.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError

REAL_KINDS = "buif"
INT32 = np.iinfo(np.int32)


def real_numbers(values: ArrayLike, name: str) -> FloatArray:
    """Return values in double precision.

    Raises
    ------
    InputError
        If they are complex, text or records.
    """
    array = np.asarray(values)
    if array.dtype.kind not in REAL_KINDS:
        raise InputError(f"{name} must be real numbers (got {array.dtype})")
    return array.astype(np.float64)


def whole_numbers(values: ArrayLike, name: str) -> IntArray:
    """Return indices or labels; floating-point numbers that are whole will do.

    Raises
    ------
    InputError
        If one is no whole number, or lies outside of 32 bits.
    """
    array: np.ndarray[Any, Any] = np.asarray(values)
    if array.size == 0:
        return np.zeros(array.shape, np.int64)
    if array.dtype.kind not in REAL_KINDS:
        raise InputError(f"{name} must be whole numbers (got {array.dtype})")
    if array.dtype.kind == "f":
        wrong = ~np.isfinite(array)
        wrong |= np.where(wrong, 0, array) != np.floor(np.where(wrong, 0, array))
        if wrong.any():
            raise InputError(
                f"{name} must be whole numbers (one is {array[wrong].flat[0]})"
            )
    least, most = array.min(), array.max()
    if least < INT32.min or most > INT32.max:
        raise InputError(f"{name} must fit 32 bits (they are {least}…{most})")
    return array.astype(np.int64)
