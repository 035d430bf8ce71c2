"""Keeps numba's compiled kernels honest.

Numba caches a kernel beside its source file and renews it when that file changes, but
not when a function it calls in another file does. Kernels here call each other across
files (an element asks a material for its stress), so all are compiled again once any
of the files is newer than what was compiled.
"""

from contextlib import suppress
from pathlib import Path

SOURCES = Path(__file__).parent


def drop_stale_kernels(folder: Path = SOURCES) -> int:
    """Delete compiled kernels older than the newest source file below a folder.

    Returns
    -------
    int
        How many were deleted. A folder that can't be written is left as it is: then
        nobody can have changed it either.
    """
    newest = max((f.stat().st_mtime for f in folder.rglob("*.py")), default=0.0)
    dropped = 0
    for index in folder.rglob("__pycache__/*.nbi"):
        with suppress(OSError):
            if index.stat().st_mtime < newest:
                index.unlink()
                dropped += 1
    return dropped
