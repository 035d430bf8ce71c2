"""Measured files as a browser sends them: announced, in pieces, bounded.

A file lies in a folder of the session's own, under a number and a suffix that is a row
of a table. What the page calls it is for the page alone.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from physgnn.errors import InputError
from physgnn.scratch import scratch_folder
from physgnn.serving.protocol.patient_messages import (
    MAX_TOTAL_BYTES,
    MOST_FILES,
    MeasuredFile,
)

UNPRINTABLE = re.compile(r"[^\x20-\x7e\xa0-\u024f]|[/\\]")


@dataclass(frozen=True)
class ReceivedFile:
    """A measured file that is here.

    Attributes
    ----------
    name : str
        What the page calls it.
    role : str
        What it is.
    path : Path
        Where it is.
    """

    name: str
    role: str
    path: Path


class Uploads:
    """The measured files of one session.

    Parameters
    ----------
    roles, suffixes : sequences of str
        What a file may be, and how its name may end.
    """

    def __init__(self, roles: Sequence[str], suffixes: Sequence[str]) -> None:
        self._roles, self._suffixes = roles, sorted(suffixes, key=len, reverse=True)
        self._folder = scratch_folder("view")
        self._receiving: tuple[ReceivedFile, BinaryIO, int] | None = None
        self._count = self._total = 0
        self.files: list[ReceivedFile] = []

    @property
    def folder(self) -> Path:
        """Where they are, and where there is room for more."""
        return Path(self._folder.name)

    def announce(self, message: MeasuredFile) -> None:
        """Expect the bytes of a file.

        Raises
        ------
        InputError
            If it is no measured file by its name, one too many or too much, or the one
            before is not whole.
        """
        name = UNPRINTABLE.sub("?", message.name)
        if self._receiving is not None:
            self._drop()
            raise InputError(f"{name}: the file before it is not whole: send it again")
        if message.role not in self._roles:
            known = ", ".join(self._roles)
            raise InputError(f"{name}: a measured file must be one of {known}")
        ends = [s for s in self._suffixes if name.lower().endswith(s)]
        if not ends:
            known = ", ".join(sorted(self._suffixes))
            raise InputError(f"{name}: a measured file must end in one of {known}")
        if len(self.files) >= MOST_FILES:
            raise InputError(f"{name}: at most {MOST_FILES} files can be measured")
        if self._total + message.n_bytes > MAX_TOTAL_BYTES:
            raise InputError(
                f"{name}: all measured files must be at most "
                f"{MAX_TOTAL_BYTES >> 20} MB together"
            )
        self._count += 1
        self._total += message.n_bytes
        path = self.folder / f"measured-{self._count}{ends[0]}"
        file = ReceivedFile(name, message.role, path)
        self._receiving = file, path.open("wb"), message.n_bytes

    def add(self, content: bytes) -> None:
        """Take the next bytes of the file that was announced.

        Raises
        ------
        InputError
            If none was, or more come than were announced.
        """
        if self._receiving is None:
            raise InputError("messages must be JSON text (got binary)")
        file, opened, left = self._receiving
        if len(content) > left:
            self._drop()
            raise InputError(f"{file.name}: more bytes came than were announced")
        opened.write(content)
        self._receiving = file, opened, left - len(content)
        if left == len(content):
            opened.close()
            self._receiving = None
            self.files.append(file)

    def forget(self) -> None:
        """Delete all files."""
        self._drop()
        for file in self.files:
            file.path.unlink(missing_ok=True)
        self.files, self._total = [], 0

    def close(self) -> None:
        """Delete the folder."""
        self._drop()
        self._folder.cleanup()

    def _drop(self) -> None:
        if self._receiving is not None:
            file, opened, _ = self._receiving
            opened.close()
            file.path.unlink(missing_ok=True)
        self._receiving = None


def states_of(
    files: Sequence[ReceivedFile], names: Mapping[str, str]
) -> list[dict[str, ReceivedFile]]:
    """Return what was measured of each state, a file a role.

    `names` are those of the roles on the page. A role with one file counts in every
    state; roles with several have one a state.

    Raises
    ------
    InputError
        If there is no file, or two roles have several but not equally many.
    """
    by_role: dict[str, list[ReceivedFile]] = {}
    for file in files:
        by_role.setdefault(file.role, []).append(file)
    counts = {len(some) for some in by_role.values() if len(some) > 1}
    if not by_role:
        raise InputError("there is nothing to register: add a measured file")
    if len(counts) > 1:
        many = ", ".join(f"{len(some)} {names[role]}" for role, some in by_role.items())
        raise InputError(f"a series must have equally many files of each ({many})")
    return [
        {role: some[i % len(some)] for role, some in by_role.items()}
        for i in range(max(counts, default=1))
    ]


def name_of(
    files: Mapping[str, ReceivedFile], states: Sequence[Mapping[str, ReceivedFile]]
) -> str:
    """Return what a state of several is called: its files that are no other's."""
    own = [
        file.name.split(".")[0]
        for role, file in files.items()
        if sum(other[role] is file for other in states) == 1
    ]
    return " + ".join(dict.fromkeys(own))


def paths_of(files: Mapping[str, ReceivedFile]) -> dict[str, Path]:
    """Return where the files of a state are, a role each."""
    return {role: file.path for role, file in files.items()}


def names_of(files: Mapping[str, ReceivedFile]) -> dict[str, str]:
    """Return what the page calls the files of a state, a role each."""
    return {role: file.name for role, file in files.items()}
