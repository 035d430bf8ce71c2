"""The one boundary between strangers' files and us.

Every reader works inside `reading`. Whatever a damaged or dishonest file can make a
parser raise leaves it as an InputError that names the file; what only a mistake of
ours raises passes through with its traceback.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from physgnn.errors import InputError

OURS = (AssertionError, NameError, ImportError)
"""No content of a file raises these: they are mistakes in the code."""
LONGEST_REASON = 160


@contextmanager
def reading(path: str | Path, what: str) -> Iterator[None]:
    """Turn whatever goes wrong with a file into one line that names it.

    Parameters
    ----------
    path : path
        The file.
    what : str
        What it should be, such as ``"a NIfTI image"``.

    Raises
    ------
    InputError
        If anything inside raises. Its cause is what was raised.
    """
    try:
        # what is not finite is refused by the types that the numbers end in
        with np.errstate(all="ignore"):
            yield
    except InputError as error:
        if str(path) in str(error):
            raise
        raise InputError(f"{path}: {error}") from error
    except OURS:
        raise
    except FileNotFoundError as error:
        raise InputError(
            f"{path}: cannot be read, there is no such file: check its name"
        ) from error
    except MemoryError as error:
        raise InputError(
            f"{path}: expected {what} that fits into memory, which this does not: "
            "close other programs or give a smaller file"
        ) from error
    except Exception as error:
        raise InputError(
            f"{path}: expected {what}, but it cannot be read ({_reason(error)}): "
            "export it again"
        ) from error


def _reason(error: Exception) -> str:
    """Return an exception's text in one short line, with its kind if need be."""
    text = (isinstance(error, OSError) and error.strerror) or str(error)
    line = " ".join(text.split())[:LONGEST_REASON]
    kind = type(error).__name__
    if not line:
        return kind
    return line if isinstance(error, OSError | ValueError) else f"{kind}: {line}"
