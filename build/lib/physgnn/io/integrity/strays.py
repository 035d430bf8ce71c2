"""What is written stands beside its place first, and a killed process leaves it there.

The name tells the process that writes, and its machine: of what is found, only what a
process of this machine left that is no longer alive is a stray, and removed.
"""

import os
import re
import shutil
import time
from pathlib import Path

from physgnn.scratch import MACHINE, is_alive

NAME = re.compile(r"\.(?P<process>\d+)(?:@(?P<machine>[0-9a-f]+))?\.(?P<name>.+)")
"""Without a machine: as earlier versions wrote, which told the process alone."""

# Zarr writes a chunk beside its place under a random name, within milliseconds.
PARTIAL, PARTIAL_SECONDS = "*.partial", 60.0


def beside(path: Path) -> Path:
    """Return where to write what shall stand at `path`; the suffixes stay last."""
    return path.with_name(f".{os.getpid()}@{MACHINE}.{path.name}")


def clear_strays(folder: Path, name: str | None = None) -> None:
    """Remove what processes that ended early left in a folder.

    Parameters
    ----------
    folder : Path
    name : str, optional
        Only what was to become a file or folder of this name; by default any.
    """
    for found in folder.glob(".*"):
        stray = NAME.fullmatch(found.name)
        if stray is None or name not in (None, stray["name"]):
            continue
        here = stray["machine"] in (None, MACHINE)
        if here and not is_alive(int(stray["process"])):
            _remove(found)


def clear_partial_chunks(store: Path) -> None:
    """Remove the chunks of a Zarr store that a killed process left unfinished."""
    for found in store.rglob(PARTIAL):
        try:
            age = time.time() - found.stat().st_mtime
        except OSError:  # it was finished meanwhile
            continue
        if age > PARTIAL_SECONDS:
            _remove(found)


def _remove(found: Path) -> None:
    if found.is_dir() and not found.is_symlink():
        shutil.rmtree(found, ignore_errors=True)
    else:
        found.unlink(missing_ok=True)
