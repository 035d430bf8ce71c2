"""Bounds on memory and disk that a user can raise by an environment variable."""

import os

from physgnn.errors import InputError

GB = 1e9


def gigabytes(variable: str, default: float) -> float:
    """Return the gigabytes that an environment variable allows, or the default.

    Raises
    ------
    InputError
        If the variable is set to anything but a number > 0.
    """
    text = os.environ.get(variable, "")
    try:
        limit = float(text) if text else default
    except ValueError:
        limit = 0.0
    if not 0.0 < limit < float("inf"):
        raise InputError(
            f"{variable} must be a number of gigabytes > 0 (got '{text}'): "
            f"set it to such as {default:g}, or leave it unset"
        )
    return limit
