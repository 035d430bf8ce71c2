"""Files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from physgnn.errors import InputError


def check_folder(path: Path) -> None:
    """Raise InputError if a file's folder is missing; ask before long work."""
    if not path.parent.is_dir():
        raise InputError(f"cannot write {path}: the folder {path.parent} is not there")


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a path beside `path` to write to; on success it takes its place.

    The process id in its name keeps two writers apart; the suffixes stay last, since
    some writers choose the format by them.

    Raises
    ------
    InputError
        If the folder does not exist.
    """
    check_folder(path)
    part = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
