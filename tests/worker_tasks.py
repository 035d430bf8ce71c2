"""Work for processes in tests, in a module that a spawned process can import."""

import os
import signal
import time
from pathlib import Path

from physgnn.errors import InputError


def named(i: int) -> tuple[str, str]:
    return f"path {i} by {os.environ['OMP_NUM_THREADS']} thread", ""


def deadly(folder: Path, worst: int, i: int) -> tuple[str, str]:
    """Path 1 kills its process the first `worst` times."""
    tries = folder / f"{i}-{time.monotonic_ns()}"
    tries.touch()
    if i == 1 and len(list(folder.glob("1-*"))) <= worst:
        os.kill(os.getpid(), signal.SIGKILL)
    return "done", ""


def refuses(_: int) -> tuple[str, str]:
    raise InputError("no solver here")


def fails(_: int) -> tuple[str, str]:
    raise RuntimeError("a bug")
