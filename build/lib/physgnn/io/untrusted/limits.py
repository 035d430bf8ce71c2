"""How much a file may ask for.

A few bytes can declare, or unpack to, more than any machine holds. A file may ask for
as many bytes as it has itself, or for `LIMIT_GB`, whichever is more. Who means a
larger one sets the environment variable ``PHYSGNN_READ_LIMIT_GB``.
"""

from pathlib import Path

from physgnn.errors import InputError
from physgnn.memory_limits import GB, gigabytes

VARIABLE = "PHYSGNN_READ_LIMIT_GB"
# A head at 0.25 mm in 16 bits, or a thousand load levels on 80,000 points.
LIMIT_GB = 2.0


def allowed_bytes(path: str | Path) -> int:
    """Return how many bytes the content of a file may take.

    Raises
    ------
    InputError
        If the environment variable is no number > 0.
    """
    limit = gigabytes(VARIABLE, LIMIT_GB)
    return max(int(limit * GB), Path(path).stat().st_size)


def check_size(path: str | Path, n_bytes: float, what: str = "its content") -> None:
    """Check what a file asks for, before it is allocated.

    Parameters
    ----------
    path : path
        The file.
    n_bytes : float
        What it declares.
    what : str
        What so many bytes are for.

    Raises
    ------
    InputError
        If that is more than allowed, or negative.
    """
    if n_bytes < 0:
        raise InputError(
            f"{path}: declares a negative size for {what}: export it again"
        )
    limit = allowed_bytes(path)
    if n_bytes > limit:
        raise InputError(
            f"{path}: {what} would take {n_bytes / GB:.3g} GB, and may take "
            f"{limit / GB:.3g} GB: export it again if it is damaged, or set "
            f"{VARIABLE}={n_bytes / GB * 1.01:.3g} if it is meant"
        )
