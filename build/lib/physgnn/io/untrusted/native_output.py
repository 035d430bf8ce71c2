"""Silence for native libraries that write to standard error by themselves."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def silent_native_code() -> Iterator[None]:
    """Send what native code writes to standard error nowhere; exceptions tell the same.

    For short calls: other threads are silent, too.
    """
    sys.stderr.flush()
    before = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(before, 2)
        os.close(before)
        os.close(nowhere)
