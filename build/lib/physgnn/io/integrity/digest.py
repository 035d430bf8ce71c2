"""Digests of what a result depends on, and the manifest that lists them.

A digest is a SHA-256 in hexadecimal. A manifest names the parts of a folder, gives the
digest of each, and one root digest over all of these. Reading a manifest checks its
root; every part is checked against it when it is first read.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import numpy as np

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import write_whole

Part = np.ndarray[Any, Any] | str | Mapping[str, Any]

FORMAT = "physgnn-manifest"
VERSION = 1
OF = "0.2"  # the version that wrote the first manifest


def digest_of(*parts: Part) -> str:
    """Return the digest of arrays (shape and bytes), texts and JSON mappings, in order.

    A mapping counts in canonical form: as JSON with sorted keys.
    """
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(f"{part.dtype.str}{part.shape}".encode())
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(json.dumps(part, sort_keys=True).encode())
    return digest.hexdigest()


def digest_of_file(path: Path) -> str:
    """Return the digest of a file's bytes.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error


def without_digest(what: str | Path) -> str:
    """Return the note on something made before there were manifests."""
    return (
        f"physgnn: {what} has no digest: it was made before {OF}; its parts cannot be "
        "checked"
    )


@dataclass(frozen=True)
class Manifest:
    """The parts of something that is kept, and the digests that each may have.

    Parameters
    ----------
    parts : mapping
        From a part's name to its digests. There is one, or two while the part is being
        replaced: whichever version a kill leaves behind is then one of them.
    """

    parts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def root(self) -> str:
        """The digest over the names and digests of all parts."""
        return digest_of({name: list(self.parts[name]) for name in self.parts})

    def with_parts(self, parts: Mapping[str, str]) -> Self:
        """Return a manifest in which each of these parts has one digest: its new."""
        return type(self)({**self.parts, **{k: (v,) for k, v in parts.items()}})

    def with_either(self, parts: Mapping[str, str]) -> Self:
        """Return a manifest in which these parts may be as they were, or new."""
        either = {
            name: tuple(dict.fromkeys((*self.parts.get(name, ()), digest)))
            for name, digest in parts.items()
        }
        return type(self)({**self.parts, **either})

    def without(self, *names: str) -> Self:
        """Return a manifest that does not have these parts."""
        return type(self)({k: v for k, v in self.parts.items() if k not in names})

    def check(self, name: str, digest: str, where: str | Path, remedy: str) -> None:
        """Raise InputError unless a part has a digest that it may have.

        Parameters
        ----------
        name : str
            The part.
        digest : str
            What it has.
        where : str or path
            What the part belongs to.
        remedy : str
            What to do if it was changed.
        """
        expected = self.parts.get(name)
        if expected is None:
            raise InputError(
                f"{where}: {name} does not belong to it (its manifest has no such "
                f"part); {remedy}"
            )
        if digest not in expected:
            raise InputError(
                f"{where}: {name} is not as it was written: it was changed, exchanged "
                f"or damaged (expected sha256 {expected[-1][:12]}…, got "
                f"{digest[:12]}…); {remedy}"
            )

    def to_json(self) -> dict[str, Any]:
        """Return what JSON can hold, with the root."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "root": self.root,
            "parts": {name: list(digests) for name, digests in self.parts.items()},
        }

    @classmethod
    def from_json(cls, values: Any, where: str | Path, remedy: str) -> Self:
        """Return the manifest that `to_json` described, its root checked.

        Raises
        ------
        InputError
            If it is no manifest, of another version, or not as it was written.
        """
        try:
            known = values["format"] == FORMAT and values["version"] == VERSION
            parts = {
                str(name): tuple(str(digest) for digest in digests)
                for name, digests in values["parts"].items()
            }
            root = values["root"]
        except (TypeError, LookupError, AttributeError, ValueError) as error:
            raise InputError(f"{where} is damaged: {remedy}") from error
        if not known:
            raise InputError(
                f"{where} is of format {values['format']} {values['version']}, this "
                f"program reads {FORMAT} {VERSION}: use the program that wrote it"
            )
        manifest = cls(parts)
        if manifest.root != root:
            raise InputError(
                f"{where} is not as it was written: it was changed or damaged (its "
                f"digests do not give its root); {remedy}"
            )
        return manifest

    def write(self, path: Path) -> None:
        """Write the manifest as a JSON file, whole or not at all."""
        write_whole(path, json.dumps(self.to_json(), indent=2) + "\n")

    @classmethod
    def read(cls, path: Path, remedy: str) -> Self | None:
        """Read a manifest's JSON file; None if there is none.

        Raises
        ------
        InputError
            As `from_json`, or if the file cannot be read.
        """
        try:
            text = path.read_text("utf-8")
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise InputError(f"{path} cannot be read ({error}): {remedy}") from error
        try:
            values = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{path} is damaged ({error}): {remedy}") from error
        return cls.from_json(values, path, remedy)
