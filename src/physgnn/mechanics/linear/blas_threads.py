"""BLAS in one thread, for small dense matrices.

OpenBLAS, which NumPy and SciPy come with, divides an inverse of 200 rows among threads
that wait by spinning. That gains little where nothing else runs, and where something
does each call waits for the scheduler: 60 ms in the place of 1 were seen. MKL's own
threads, which factorise sparse matrices, are left alone.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

OPENBLAS = "openblas"


@cache
def _openblas() -> ThreadpoolController:
    import scipy.linalg  # noqa: F401 (NumPy and SciPy have a library each: both are there)

    return ThreadpoolController().select(internal_api=OPENBLAS)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Have NumPy and SciPy multiply and solve in one thread inside of this."""
    with _openblas().limit(limits=1):
        yield
