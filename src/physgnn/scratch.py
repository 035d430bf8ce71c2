"""Temporary folders that go when they are done with, at the end, or at the next start.

A signal may come between the making of a folder and the first line that would remove
it: the process removes what it has left as it ends. One that is killed cannot. The
names tell the machine, the process, and when that began: whoever starts next removes
those of processes that are no longer there.
"""

import atexit
import hashlib
import os
import platform
import re
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

# Many machines may write to one shared folder, and their process ids coincide.
MACHINE = hashlib.sha256(platform.node().encode()).hexdigest()[:8]
NAME = re.compile(
    r"physgnn-[a-z]+-(?P<machine>[0-9a-f]{8})-(?P<process>\d+)-(?P<began>\d+)-.+"
)
STARTED_FIELD = 22  # of /proc/<id>/stat, counted from 1: proc(5)

_cleared: set[Path] = set()


def scratch_folder(what: str) -> "tempfile.TemporaryDirectory[str]":
    """Return a temporary folder, as `tempfile.TemporaryDirectory` makes it.

    Parameters
    ----------
    what : str
        What it is for, in lower-case letters: part of its name.
    """
    clear_at_start()
    return tempfile.TemporaryDirectory(prefix=prefix(what))


def prefix(what: str) -> str:
    """Return how the name of a folder of this process begins."""
    return f"physgnn-{what}-{_of_this_process()}-"


def _of_this_process() -> str:
    process = os.getpid()
    return f"{MACHINE}-{process}-{began(process) or 0}"


def clear_at_start() -> None:
    """Remove, unless this process did so before, what dead processes left."""
    folder = Path(tempfile.gettempdir())
    if folder not in _cleared:
        _cleared.add(folder)
        atexit.register(_clear_own, folder)
        clear(folder)


def _clear_own(folder: Path) -> None:
    """Remove what this process made there and a signal kept it from removing."""
    with suppress(OSError):
        for left in folder.glob(f"physgnn-*-{_of_this_process()}-*"):
            shutil.rmtree(left, ignore_errors=True)


def clear(folder: Path) -> None:
    """Remove the temporary folders of processes of this machine that are dead."""
    with suppress(OSError):
        for found in folder.glob(f"physgnn-*-{MACHINE}-*"):
            name = NAME.fullmatch(found.name)
            if name is None or found.is_symlink():
                continue
            if not is_alive(int(name["process"]), int(name["began"])):
                shutil.rmtree(found, ignore_errors=True)


def is_alive(process: int, start: int | None = None) -> bool:
    """Whether a process is there, and is the one that began then.

    Parameters
    ----------
    process : int
        Its id, which the system gives to another process later on.
    start : int, optional
        As `began` returned it; by default any process of this id counts.
    """
    import psutil

    try:
        if not psutil.pid_exists(process):
            return False
    except OverflowError:
        return False
    now = began(process)
    return start is None or now is None or now == start


def began(process: int) -> int | None:
    """Return a number for when a process began; None if it is not there.

    On Linux this is the clock's ticks since the machine was started, which do not move
    when the machine's time is set; elsewhere seconds since 1970.
    """
    stat = Path(f"/proc/{process}/stat")
    try:
        # the program's name, in brackets, may hold spaces and brackets
        after_name = stat.read_text("utf-8", errors="replace").rpartition(")")[2]
        return int(after_name.split()[STARTED_FIELD - 3])
    except OSError:
        pass
    import psutil

    try:
        return int(psutil.Process(process).create_time())
    except (psutil.Error, OverflowError):
        return None
