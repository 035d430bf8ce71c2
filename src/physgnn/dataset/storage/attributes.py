"""The attributes of a store: what it says of itself, checked when it is opened.

Since version 2 they hold a digest of every array of the definition, and a root digest
over all attributes. Opening a store checks the root; an array is checked against its
own digest when it is read.
"""

import logging
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    NonNegativeInt,
    PositiveInt,
    ValidationError,
)

from physgnn.errors import InputError
from physgnn.io.integrity.digest import digest_of, without_digest
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT

FORMAT = "physgnn-dataset"
VERSION = 2
WITHOUT_DIGESTS = 1
"""The version before there were digests of attributes and arrays."""

ROOT = "root"


class Attributes(BaseModel):
    """What docs/reference/data_format.md says of each.

    Raises
    ------
    pydantic.ValidationError
        If one is missing or of another type.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    version: int
    n_paths: PositiveInt
    training_paths: NonNegativeInt = 0
    n_points: PositiveInt
    mesh_hash: str
    definition_hash: str
    point_sets: list[str]
    element: str = DEFAULT_ELEMENT
    materials: dict[str, dict[str, Any]]
    more_loads: list[dict[str, Any]] = Field(default_factory=list)
    provenance: dict[str, Any]
    arrays: dict[str, str] = Field(default_factory=dict)

    @property
    def has_digests(self) -> bool:
        """Whether there is a digest of every array of the definition."""
        return self.version != WITHOUT_DIGESTS

    @classmethod
    def checked(cls, values: Mapping[str, Any], path: Path) -> Self:
        """Return the attributes of the store at `path`.

        Raises
        ------
        InputError
            If they are not those of a store, of a version that this program does not
            read, or not as they were written.
        """
        _check_format(values, path)
        rest = {name: value for name, value in values.items() if name != ROOT}
        has_root = values["version"] != WITHOUT_DIGESTS or ROOT in values
        if has_root and values.get(ROOT) != digest_of(rest):
            raise InputError(
                f"store {path}: its attributes (zarr.json) are not as they were "
                "written: they were changed or damaged; bring the store back from a "
                "copy, or delete it and simulate again"
            )
        try:
            return cls.model_validate(rest)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(str(key) for key in first["loc"])
            raise InputError(
                f"store {path}: attribute '{where}' in zarr.json is damaged "
                f"({first['msg']}); bring the store back from a copy, or delete it "
                "and simulate again"
            ) from error


def with_root(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes with the root digest over all of them."""
    return {**values, ROOT: digest_of(values)}


@lru_cache(maxsize=256)
def note_without_digests(path: Path) -> None:
    """Log, once a process, that a store was made before there were digests."""
    logging.getLogger(__name__).warning(without_digest(f"store {path}"))


def _check_format(values: Mapping[str, Any], path: Path) -> None:
    """Raise InputError if it is another format, or a version that is not known."""
    if values.get("format") != FORMAT:
        raise InputError(
            f"{path} is a Zarr group but not a dataset store (format "
            f"{values.get('format')!r}, expected {FORMAT!r})"
        )
    version = values.get("version")
    if type(version) is not int or version not in (WITHOUT_DIGESTS, VERSION):
        raise InputError(
            f"store {path} has format version {version}, this program reads version "
            f"{WITHOUT_DIGESTS} and {VERSION}: simulate again, or use the program of "
            "that version"
        )
