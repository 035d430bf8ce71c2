"""Files and folders that appear whole or not at all.

Whatever this package writes for others to read goes through here. What a writer left
is on the disk and looked at before it takes its place: VTK, for one, reports no error
when the disk is full.
"""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.integrity.completeness import what_is_missing
from physgnn.io.integrity.strays import beside, clear_strays


def check_folder(path: Path) -> None:
    """Raise InputError if there can be no such file; ask before long work."""
    if not path.parent.is_dir():
        raise InputError(
            f"cannot write {path}: the folder {path.parent} is not there: make it, or "
            "name another"
        )
    if path.exists() and not path.is_file():
        raise InputError(f"cannot write {path}: it is no file: name a file")


@contextmanager
def whole_file(
    path: Path,
    *,
    refused: tuple[type[Exception], ...] = (),
    may_be_empty: bool = False,
) -> Iterator[Path]:
    """Yield a path beside `path` to write to; on success it takes its place.

    The process id in its name keeps two writers apart; the suffixes stay last, since
    some writers choose the format by them. An older file stays as it is until the new
    one is on the disk and complete. What a killed process left of the same file is
    removed.

    Parameters
    ----------
    path : Path
        The file.
    refused : tuple of exception types
        What the writer raises, beside OSError, if it cannot write.
    may_be_empty : bool
        Whether a file of no bytes is complete.

    Raises
    ------
    InputError
        If the folder does not exist, or the file cannot be written whole.
    """
    check_folder(path)
    clear_strays(path.parent, path.name)
    part = beside(path)
    try:
        with _refusals(path, refused):
            yield part
            _check(part, path, may_be_empty=may_be_empty)
            part.replace(path)
            _to_disk(path.parent)
    finally:
        part.unlink(missing_ok=True)


def reserve(path: Path, n_bytes: int) -> None:
    """Make a file of so many bytes, to learn whether there is room; OSError if not."""
    with path.open("wb") as file:
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(file.fileno(), 0, n_bytes)
        else:
            file.write(bytes(n_bytes))


def write_whole(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all.

    Raises
    ------
    InputError
        If the folder does not exist, or the file cannot be written whole.
    """
    with whole_file(path, may_be_empty=not text) as part:
        part.write_text(text, "utf-8")


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Yield a path beside `path` to make a folder at; on success it takes its place.

    The folder that shall hold both is made if it is missing. Every file in it is on the
    disk and complete before it takes its place. What a killed process left of the same
    folder is removed.

    Raises
    ------
    InputError
        If there is something at `path` already, or the folder cannot be written whole.
    """
    if path.exists():
        raise InputError(f"{path} exists already: name another folder")
    part = beside(path)
    try:
        with _refusals(path, ()):
            path.parent.mkdir(parents=True, exist_ok=True)
            clear_strays(path.parent, path.name)
            yield part
            for inner in sorted(part.rglob("*")):
                _check(inner, path / inner.relative_to(part))
            part.rename(path)
            _to_disk(path.parent)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _check(part: Path, path: Path, *, may_be_empty: bool = False) -> None:
    """Raise InputError unless what shall stand at `path` is whole and on the disk."""
    _to_disk(part)
    missing = what_is_missing(part, may_be_empty=may_be_empty)
    if missing is not None:
        raise InputError(
            f"cannot write {path}: {missing}; is the disk full, or a quota used up?"
        )


@contextmanager
def _refusals(path: Path, refused: tuple[type[Exception], ...]) -> Iterator[None]:
    """Name the file that was wanted, not the one beside it."""
    try:
        yield
    except InputError as error:
        if beside(path).name not in str(error):
            raise
        text = str(error).replace(beside(path).name, path.name)
        raise InputError(text) from error
    except OSError as error:
        names = [name for name in (error.filename, error.filename2) if name is not None]
        if names and not any(_is_part(name, path) for name in names):
            raise  # of another file
        raise InputError(f"cannot write {path}: {error.strerror or error}") from error
    except refused as error:
        reason = " ".join(str(error).split()).replace(beside(path).name, path.name)
        raise InputError(f"cannot write {path}: {reason}") from error


def _is_part(name: object, path: Path) -> bool:
    return beside(path).name in str(name) or str(name) in (str(path), str(path.parent))


def _to_disk(path: Path) -> None:
    """Have the system write what it holds back: only then a full disk is known."""
    if not path.exists():
        return
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    finally:
        os.close(opened)
