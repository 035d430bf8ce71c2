"""The results of a store's load paths: written a path at a time, checked when read."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset.storage import layout
from physgnn.dataset.storage.reader import StoreReader
from physgnn.dataset.storage.result_rows import (
    digest_row,
    encoded,
    path_identity,
    result_arrays,
    seal_row,
)
from physgnn.errors import InputError
from physgnn.mechanics.equilibrium.solution import Solution, Status

LARGE = "displacement"


class StoredResults:
    """The rows of every array under ``result``.

    Parameters
    ----------
    reader : StoreReader
        The store.
    n_levels : int
        Levels of every path.
    cache_bytes : int
        How much of the displacement to keep in memory, bytes.
    """

    def __init__(self, reader: StoreReader, n_levels: int, cache_bytes: int) -> None:
        self._reader = reader
        self._arrays = result_arrays(n_levels, reader.attributes.n_points)
        has_seals = reader.attributes.has_digests
        self._names = [name for name in self._arrays if name != "seal" or has_seals]
        self._checked: set[int] = set()
        path_bytes = max(12 * n_levels * reader.attributes.n_points, 1)
        # All entries have the same size, so a bound on their number bounds the bytes.
        self.displacement = lru_cache(maxsize=max(cache_bytes // path_bytes, 1))(
            self._read_displacement
        )

    def row(self, name: str, i: int | None = None) -> np.ndarray[Any, Any]:
        """Read an array's row of path `i`, or of all paths."""
        shape, dtype, _ = self._arrays[name]
        return self._reader.rows(f"result/{name}", i, shape=shape, dtype=dtype)

    def write(self, i: int, solution: Solution) -> None:
        """Store the solution of path `i`; its status goes last.

        Raises
        ------
        InputError
            If the disk does not take it. The path is then pending.
        """
        self._checked.discard(i)
        rows = encoded(solution, self._identity(i))
        for name in self._names:
            layout.write_row(self._reader.group, f"result/{name}", i, rows[name])

    def is_pending(self, i: int) -> bool:
        """Return whether path `i` has no result."""
        return bool((self.row("status", i) == Status.NOT_SOLVED).all())

    def _read_displacement(self, i: int) -> NDArray[np.float32]:
        if self.is_pending(i):
            raise InputError(
                f"store {self._reader.path}: load path {i} has no result yet; run "
                "'physgnn simulate' again to resume"
            )
        values: NDArray[np.float32] = self.row(LARGE, i)
        if np.isnan(values).any():  # what Zarr gives for a chunk that is not there
            raise self._damaged(i, "chunk missing")
        if i not in self._checked:
            self._check(i, values)
        values.flags.writeable = False
        return values

    def _check(self, i: int, displacement: NDArray[np.float32]) -> None:
        """Raise InputError unless path `i`'s results are as they were written."""
        row = {name: self.row(name, i) for name in self._names if name != LARGE}
        row[LARGE] = displacement
        expected = {"digest": digest_row(row)}
        if "seal" in row:
            expected["seal"] = seal_row(row, self._identity(i))
        if not all(np.array_equal(row[name], expected[name]) for name in expected):
            raise self._damaged(i, "not as it was written: changed or exchanged")
        self._checked.add(i)

    def _damaged(self, i: int, reason: str) -> InputError:
        name = f"result/{LARGE}"
        return InputError(layout.damaged(self._reader.group, name, i, reason))

    def _identity(self, i: int) -> str:
        return path_identity(self._reader.attributes.definition_hash, i)
