"""Signals that end a run, as exceptions, so that whatever is open is closed on the way.

Ctrl-C and SIGTERM raise `Interrupted`. It is a `SystemExit`, which asyncio, Lightning
and process pools pass on; Lightning would answer a KeyboardInterrupt with a message and
exit code of its own.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
PATIENCE_SECONDS = 5.0  # for threads to end; then the process does

_received: int | None = None


class Interrupted(SystemExit):
    """The run was asked to end; the exit code is 128 and the signal's number."""

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.number = number


def received() -> int | None:
    """Return the number of the signal that asked this process to end, if one did."""
    return _received


def name_of(number: int) -> str:
    """Return what a signal means for the user: "interrupted" or "terminated"."""
    return "interrupted" if number == signal.SIGINT else "terminated"


@contextmanager
def raising() -> Iterator[None]:
    """Raise `Interrupted` on SIGINT and SIGTERM within, in the main thread.

    A second SIGTERM changes nothing; a second Ctrl-C also cuts short the cleaning up.
    """
    global _received
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, _raise) for number in SIGNALS}
    hook, sys.unraisablehook = sys.unraisablehook, _again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)
        _received = None


def ignore_in_worker() -> None:
    """Leave Ctrl-C to the process that started this worker; SIGTERM ends it silently.

    For the initializers of process pools: a terminal sends Ctrl-C to every process.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _raise)


def _raise(number: int, _: FrameType | None) -> NoReturn:
    global _received
    _received = number
    if number == signal.SIGTERM:
        signal.signal(number, signal.SIG_IGN)
    raise Interrupted(number)


def _again(unraisable: Any) -> None:
    """Raise anew what was lost in a destructor or a callback of the interpreter.

    From another thread, since what is raised in here would be lost, too.
    """
    if not isinstance(unraisable.exc_value, Interrupted):
        sys.__unraisablehook__(unraisable)
        return
    number = unraisable.exc_value.number
    signal.signal(number, _raise)
    _later(0.01, os.kill, os.getpid(), number)


def end_children() -> None:
    """End every process that this one started, and theirs; kill those that stay."""
    import psutil

    children = [
        child
        for child in psutil.Process().children(recursive=True)
        if not _ends_with_us(child)
    ]
    for stop in (psutil.Process.terminate, psutil.Process.kill):
        for child in children:
            with suppress(psutil.Error):
                stop(child)
        _, children = psutil.wait_procs(children, timeout=PATIENCE_SECONDS / 2)


def _ends_with_us(child: Any) -> bool:
    """Whether a process is Python's tracker of shared memory, or has ended."""
    import psutil

    try:
        return "resource_tracker" in " ".join(child.cmdline())
    except psutil.Error:
        return True


def end_soon(code: int) -> None:
    """End this process after a while, even if a thread does not."""
    _later(PATIENCE_SECONDS, os._exit, code)


def _later(seconds: float, act: Callable[..., object], *values: int) -> None:
    timer = threading.Timer(seconds, act, values)
    timer.daemon = True
    timer.start()
