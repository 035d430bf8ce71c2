"""How a dataset lies on disk: the arrays of the Zarr store, and reading them safely.

docs/reference/data_format.md describes the same for readers in other languages.
"""

from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec

from physgnn.errors import InputError

FORMAT = "physgnn-dataset"
VERSION = 1

# Measured on FEBio's 30-level answers (3.40 MB a path raw): 2.72 MB, 3.5 ms to read,
# 32 ms to write; bit shuffle, lz4 and lower levels are all larger and none reads faster
# by more than a millisecond. The checksum comes last, so it covers what is on disk.
CODECS = (
    BloscCodec(cname="zstd", clevel=5, shuffle="shuffle", typesize=4),
    Crc32cCodec(),
)


def put_array(group: zarr.Group, name: str, value: np.ndarray[Any, Any]) -> None:
    """Store an array in one checksummed chunk."""
    chunks = tuple(max(n, 1) for n in value.shape)
    group.create_array(name, data=value, chunks=chunks, compressors=CODECS)


def put_rows(
    group: zarr.Group, name: str, shape: tuple[int, ...], dtype: str, fill: float
) -> None:
    """Make an empty array of one chunk a row, so rows can be written side by side."""
    group.create_array(
        name,
        shape=shape,
        chunks=(1, *shape[1:]),
        dtype=dtype,
        fill_value=fill,
        compressors=CODECS,
    )


def read(group: zarr.Group, name: str, row: int | None = None) -> np.ndarray[Any, Any]:
    """Read an array or one row of it.

    Raises
    ------
    InputError
        If the data is missing or its checksum is wrong; names the chunk and the remedy.
    """
    try:
        array = group[name]
        assert isinstance(array, zarr.Array)
        return np.asarray(array[...] if row is None else array[row])
    except (ValueError, KeyError, OSError, RuntimeError) as error:
        raise InputError(damaged(group, name, row, str(error))) from error


def read_all(group: zarr.Group, name: str) -> dict[str, np.ndarray[Any, Any]]:
    """Read all arrays of a group by name; a group that is not there has none."""
    names = group[name].array_keys() if name in group else ()  # type: ignore[union-attr]
    return {key: read(group, f"{name}/{key}") for key in names}


def damaged(group: zarr.Group, name: str, row: int | None, reason: str) -> str:
    """Return the one line that says which chunk is damaged and what to do."""
    path = store_path(group)
    where = f"array '{name}'" + ("" if row is None else f" of load path {row}")
    reason = reason.split(".")[0]
    if not name.startswith("result/"):
        return (
            f"store {path}: {where} is damaged ({reason}); bring the store back from a "
            "copy, or delete it and simulate again"
        )
    status = "result/status/c/" + ("…" if row is None else f"{row}/0")
    return (
        f"store {path}: {where} is damaged ({reason}); delete {status} in it "
        "and simulate again to solve that path anew"
    )


def open_group(path: Path) -> zarr.Group:
    """Open the root group of a store.

    Raises
    ------
    InputError
        If there is no store, it is something else, or its version is another.
    """
    if not path.is_dir():
        raise InputError(f"{path} is not a dataset store: no such folder")
    try:
        group = zarr.open_group(path, mode="r+")
    except (ValueError, KeyError, OSError) as error:
        raise InputError(
            f"{path} is not a dataset store: it has no readable zarr.json; "
            "make one with 'physgnn simulate'"
        ) from error
    if group.attrs.get("format") != FORMAT:
        raise InputError(
            f"{path} is a Zarr group but not a dataset store (format "
            f"{group.attrs.get('format')!r}, expected {FORMAT!r})"
        )
    if group.attrs.get("version") != VERSION:
        raise InputError(
            f"store {path} has format version {group.attrs.get('version')}, this "
            f"program reads version {VERSION}: simulate again, or use the program of "
            "that version"
        )
    return group


def store_path(group: zarr.Group) -> Path:
    """Return the folder of a store's root group."""
    return Path(str(group.store).removeprefix("file://"))
