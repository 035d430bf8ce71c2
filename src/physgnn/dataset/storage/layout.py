"""How a dataset lies on disk: the arrays of the Zarr store, and reading them safely.

docs/reference/data_format.md describes the same for readers in other languages.
Whatever reading a store can raise becomes `InputError` here.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from physgnn.errors import InputError

if TYPE_CHECKING:
    import zarr

# An array may take this much memory whatever is on disk, bytes, and beyond it this many
# times what is: a shape that someone edited is not to use up the memory.
ALWAYS_ALLOWED, MOST_TIMES_DISK = 2**26, 1000


def put_array(group: "zarr.Group", name: str, value: np.ndarray[Any, Any]) -> None:
    """Store an array in one checksummed chunk."""
    chunks = tuple(max(n, 1) for n in value.shape)
    group.create_array(name, data=value, chunks=chunks, compressors=_codecs())


def put_rows(
    group: "zarr.Group", name: str, shape: tuple[int, ...], dtype: str, fill: float
) -> None:
    """Make an empty array of one chunk a row, so rows can be written side by side."""
    group.create_array(
        name,
        shape=shape,
        chunks=(1, *shape[1:]),
        dtype=dtype,
        fill_value=fill,
        compressors=_codecs(),
    )


def _codecs() -> tuple[Any, ...]:
    from zarr.codecs import BloscCodec, Crc32cCodec

    # Measured on FEBio's displacements of 30 levels (3.40 MB a path raw): 2.72 MB,
    # 3.5 ms to read, 32 ms to write; bit shuffle, lz4 and lower levels are all larger
    # and none reads faster by more than a millisecond. The checksum comes last, so it
    # covers what is on disk.
    packed = BloscCodec(cname="zstd", clevel=5, shuffle="shuffle", typesize=4)
    return packed, Crc32cCodec()


def has(group: "zarr.Group", name: str) -> bool:
    """Return whether there is such an array."""
    with _reading(group, name):
        return name in group


def read(group: "zarr.Group", name: str) -> np.ndarray[Any, Any]:
    """Read an array that lies in one chunk.

    Raises
    ------
    InputError
        If the data is missing, its checksum is wrong, or it claims a size that what
        is on disk cannot have; names the array and the remedy.
    """
    with _reading(group, name):
        array = _array(group, name)
        if array.nbytes > ALWAYS_ALLOWED:
            folder = store_path(group) / name
            there = sum(f.stat().st_size for f in folder.rglob("*") if f.is_file())
            if array.nbytes > MOST_TIMES_DISK * there:
                raise ValueError(f"{array.nbytes} bytes of {there} on disk")
        return np.asarray(array[...])


def read_rows(
    group: "zarr.Group",
    name: str,
    row: int | None = None,
    *,
    shape: tuple[int, ...],
    dtype: str,
) -> np.ndarray[Any, Any]:
    """Read an array that has a chunk a row, or one row of it.

    Parameters
    ----------
    group : zarr.Group
        The store.
    name : str
        The array.
    row : int, optional
        By default all are read.
    shape, dtype
        Of the whole array.

    Raises
    ------
    InputError
        If the array is of another shape or type, a chunk's checksum is wrong, or
        there is no such row; names the chunk and the remedy.
    """
    with _reading(group, name):
        array = _array(group, name)
        if array.shape != shape or array.dtype != np.dtype(dtype):
            raise ValueError(
                f"{array.dtype} of shape {array.shape}, expected {dtype} of {shape}"
            )
    if row is not None:
        return _row(group, name, array, row)
    with suppress(Exception):  # what is damaged is found, and named, below
        return np.asarray(array[...])
    return np.stack([_row(group, name, array, i) for i in range(shape[0])])


def _row(
    group: "zarr.Group", name: str, array: "zarr.Array[Any]", row: int
) -> np.ndarray[Any, Any]:
    with _reading(group, name, row):
        return np.asarray(array[row])


def write_row(group: "zarr.Group", name: str, row: int, value: Any) -> None:
    """Write a row of an array, whole or not at all.

    Raises
    ------
    InputError
        If the disk does not take it: no row after it will fit either.
    """
    with writing(group):
        group[name][row] = value  # type: ignore[index]


@contextmanager
def writing(group: "zarr.Group") -> Iterator[None]:
    """Turn what the disk refuses into one line that says how to go on."""
    try:
        yield
    except OSError as error:
        raise InputError(
            f"store {store_path(group)} cannot be written ({error.strerror or error}): "
            "make room, or see who may write there, and run the same command again: "
            "it goes on from here"
        ) from error


def names_in(group: "zarr.Group", folder: str) -> list[str]:
    """Return the names of the arrays of a group; one that is not there has none."""
    import zarr

    with _reading(group, folder):
        inner = group.get(folder)
        return sorted(inner.array_keys()) if isinstance(inner, zarr.Group) else []


def damaged(group: "zarr.Group", name: str, row: int | None, reason: str) -> str:
    """Return the one line that says which chunk is damaged and what to do."""
    path = store_path(group)
    where = f"array '{name}'" + ("" if row is None else f" of load path {row}")
    reason = " ".join(reason.split(". ")[0].split()).rstrip(".")
    if row is None or not name.startswith("result/"):
        return (
            f"store {path}: {where} is damaged ({reason}); bring the store back from a "
            "copy, or delete it and simulate again"
        )
    return (
        f"store {path}: {where} is damaged ({reason}); delete result/status/c/{row}/0 "
        "in it and simulate again to solve that path anew"
    )


def open_group(path: Path) -> "zarr.Group":
    """Open the root group of a store; see `attributes` for what must be in it.

    Raises
    ------
    InputError
        If there is no folder, or it is no Zarr group.
    """
    import zarr

    if not path.is_dir():
        raise InputError(f"{path} is not a dataset store: no such folder")
    try:
        return zarr.open_group(path, mode="r+")
    except Exception as error:  # whatever Zarr makes of a file that someone edited
        raise InputError(
            f"{path} is not a dataset store: it has no readable zarr.json; "
            "make one with 'physgnn simulate'"
        ) from error


def store_path(group: "zarr.Group") -> Path:
    """Return the folder of a store's root group."""
    return Path(str(group.store).removeprefix("file://"))


def _array(group: "zarr.Group", name: str) -> "zarr.Array[Any]":
    import zarr

    array = group[name]
    if not isinstance(array, zarr.Array):
        raise TypeError("a group, not an array")
    return array


@contextmanager
def _reading(group: "zarr.Group", name: str, row: int | None = None) -> Iterator[None]:
    """Turn whatever reading of the store raises into one line of `InputError`."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # files that someone edited make Zarr raise anything
        reason = str(error) or type(error).__name__
        raise InputError(damaged(group, name, row, reason)) from error
