"""What a store remembers of its check against full Newton: a row a load path.

A path counts as checked once its distance is there: it is written last. The digest of
a row covers the path's number, the level and the distance.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage import layout
from physgnn.dataset.storage.reader import StoreReader
from physgnn.dataset.storage.result_rows import path_identity
from physgnn.errors import InputError
from physgnn.io.integrity.digest import digest_of

GROUP = "verification"
# Name to the row's shape, type and fill value, in the order of writing.
ROWS: dict[str, tuple[tuple[int, ...], str, float]] = {
    "level": ((), "int32", -1),
    "digest": ((32,), "uint8", 0),
    "distance_mm": ((), "float64", np.nan),
}


def make_rows(reader: StoreReader) -> None:
    """Make the arrays that are missing: a run may have been killed between two."""
    for name in _names(reader):
        if not layout.has(reader.group, f"{GROUP}/{name}"):
            shape, dtype, fill = ROWS[name]
            of_all = (reader.attributes.n_paths, *shape)
            with layout.writing(reader.group):
                layout.put_rows(reader.group, f"{GROUP}/{name}", of_all, dtype, fill)


def write_row(reader: StoreReader, i: int, level: int, distance_mm: float) -> None:
    """Store how far a level of path `i` is from equilibrium; the distance goes last."""
    row: dict[str, Any] = {
        "level": level,
        "digest": _digest(reader, i, level, distance_mm),
        "distance_mm": distance_mm,
    }
    for name in _names(reader):
        layout.write_row(reader.group, f"{GROUP}/{name}", i, row[name])


def read_rows(reader: StoreReader) -> tuple[IntArray, FloatArray]:
    """Return (path, level) of every checked level, (n, 2), and the distances, mm.

    Raises
    ------
    InputError
        If a row is damaged, or not as it was written.
    """
    if not all(layout.has(reader.group, f"{GROUP}/{name}") for name in _names(reader)):
        return np.empty((0, 2), dtype=np.int64), np.empty(0)
    row = {
        name: reader.rows(f"{GROUP}/{name}", shape=ROWS[name][0], dtype=ROWS[name][1])
        for name in _names(reader)
    }
    level, distance = row["level"], row["distance_mm"]
    paths = np.flatnonzero(~np.isnan(distance))
    for i in paths.tolist() if "digest" in row else ():
        digest = _digest(reader, i, int(level[i]), float(distance[i]))
        if not np.array_equal(digest, row["digest"][i]):
            raise InputError(
                f"store {reader.path}: what is stored of the check of load path {i} is "
                f"not as it was written: changed or exchanged; delete {GROUP} in it "
                "and simulate again to check anew"
            )
    return np.stack([paths, level[paths]], axis=1), distance[paths]


def _names(reader: StoreReader) -> list[str]:
    """Return the arrays there are; stores of version 1 have no digests."""
    return [k for k in ROWS if k != "digest" or reader.attributes.has_digests]


def _digest(reader: StoreReader, i: int, level: int, distance: float) -> NDArray[Any]:
    identity = path_identity(reader.attributes.definition_hash, i)
    said = {"level": level, "distance_mm": float(distance).hex()}
    return np.frombuffer(bytes.fromhex(digest_of(identity, said)), "u1")
