"""Reads a store, and checks every part against its digest when it is read."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from physgnn.dataset.storage import layout
from physgnn.dataset.storage.attributes import Attributes
from physgnn.errors import InputError
from physgnn.io.integrity.digest import digest_of

if TYPE_CHECKING:
    import zarr


@dataclass(frozen=True, eq=False)
class StoreReader:
    """An open store: its attributes, which are checked, and the way to its arrays.

    Attributes
    ----------
    path : Path
    group : zarr.Group
    attributes : Attributes
    """

    path: Path
    group: "zarr.Group"
    attributes: Attributes

    @classmethod
    def open(cls, path: Path) -> Self:
        """Open a store; InputError if it is none, of another version, or damaged."""
        group = layout.open_group(path)
        return cls(path, group, Attributes.checked(dict(group.attrs), path))

    def part(self, name: str) -> np.ndarray[Any, Any]:
        """Read an array of the definition.

        Raises
        ------
        InputError
            If it is missing, damaged, or not as it was written.
        """
        value = layout.read(self.group, name)
        said = self.attributes
        if said.has_digests and digest_of(value) != said.arrays.get(name):
            reason = "not as it was written: changed or exchanged"
            raise InputError(layout.damaged(self.group, name, None, reason))
        return value

    def parts(self, folder: str) -> dict[str, np.ndarray[Any, Any]]:
        """Read all arrays of a group by name, as `part`; there may be none."""
        names = layout.names_in(self.group, folder)
        return {name: self.part(f"{folder}/{name}") for name in names}

    def rows(
        self, name: str, row: int | None = None, *, shape: tuple[int, ...], dtype: str
    ) -> np.ndarray[Any, Any]:
        """Read an array that has a row a load path, or one row of it.

        Parameters
        ----------
        name : str
            The array.
        row : int, optional
            By default all are read.
        shape, dtype
            Of a row.
        """
        whole = (self.attributes.n_paths, *shape)
        return layout.read_rows(self.group, name, row, shape=whole, dtype=dtype)

    @contextmanager
    def making(self, what: str) -> Iterator[None]:
        """Turn whatever goes wrong when parts are put together into `InputError`."""
        try:
            yield
        except Exception as error:  # a record that someone edited can raise anything
            if isinstance(error, InputError) and str(self.path) in str(error):
                raise
            reason = str(error) or type(error).__name__
            raise InputError(layout.damaged(self.group, what, None, reason)) from error
