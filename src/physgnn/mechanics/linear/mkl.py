"""MKL's runtime library, found without a search and made to repeat itself."""

import ctypes
import os
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any

NAMED = "PYPARDISO_MKL_RT"  # where a user says that the library is
LIBRARY = "mkl_rt"
_CBWR_AUTO, _CBWR_STRICT = 2, 0x10000  # mkl_types.h: conditional reproducibility


@cache
def mkl_library() -> Any:
    """Return MKL's runtime library, or None where it is not installed."""
    place = _installed() or _found()
    if place is None:
        return None
    mkl = ctypes.CDLL(place)
    # Otherwise the last bits depend on where in memory arrays happen to lie.
    mkl.MKL_CBWR_Set(_CBWR_AUTO | _CBWR_STRICT)
    return mkl


def all_threads() -> int:
    """Return how many threads a solver may have: OMP_NUM_THREADS, else all cores."""
    mkl = mkl_library()
    if mkl is None:
        return 1
    mkl.MKL_Set_Num_Threads_Local(0)  # what the last solver had is not what there is
    return int(mkl.MKL_Get_Max_Threads())


def _installed() -> str | None:
    """Return where pip's record says that the library is, unless a user says it."""
    if NAMED in os.environ:
        return None
    with suppress(PackageNotFoundError):
        for file in files("mkl") or ():
            place = Path(str(file.locate())).resolve()
            if LIBRARY in place.name and place.is_file():
                return str(place)
    return None


def _found() -> str | None:
    """Return where pypardiso finds the library, if need be among all that is installed.

    That search takes a second or more.
    """
    try:
        from pypardiso import PyPardisoSolver
    except ImportError:
        return None
    return str(PyPardisoSolver().libmkl._name)
