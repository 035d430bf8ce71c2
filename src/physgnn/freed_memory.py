"""Memory that a process has freed, given back to the system."""

import contextlib
import ctypes
import gc


def give_back() -> None:
    """Free what is in cycles, and return freed memory to the system.

    Large arrays in a cycle wait for a collection that counts objects, not bytes. Of C
    libraries only glibc keeps what was freed and can be asked for it.
    """
    gc.collect()
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)
