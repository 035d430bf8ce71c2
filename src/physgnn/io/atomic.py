"""Files and folders that appear whole or not at all.

Whatever this package writes for others to read goes through here.
"""

import os
import shutil
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
    part = _beside(path)
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all.

    Raises
    ------
    InputError
        If the folder does not exist.
    """
    with whole_file(path) as part:
        part.write_text(text, "utf-8")


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Yield a path beside `path` to make a folder at; on success it takes its place.

    The folder that shall hold both is made if it is missing.

    Raises
    ------
    InputError
        If there is something at `path` already.
    """
    if path.exists():
        raise InputError(f"{path} exists already: name another folder")
    path.parent.mkdir(parents=True, exist_ok=True)
    part = _beside(path)
    try:
        yield part
        part.rename(path)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _beside(path: Path) -> Path:
    return path.with_name(f".{os.getpid()}.{path.name}")
