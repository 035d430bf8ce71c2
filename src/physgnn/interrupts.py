"""Signals that end a run, as exceptions, so that whatever is open is closed on the way.

Ctrl-C and SIGTERM raise `Interrupted`. It is a SystemExit, which asyncio, Lightning
and process pools pass on; Lightning would answer a KeyboardInterrupt with a message and
exit code of its own.
"""

import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Any, NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
PATIENCE_SECONDS = 5.0  # for threads to end; then the process does

RETRY_SECONDS = 0.02
IMPORT_SECONDS = 2.0  # longer imports are cut short: nothing of ours is half written
IMPORTER = "<frozen importlib._bootstrap>"

_received: int | None = None
_since = 0.0
_hook: Callable[[Any], object] = sys.__unraisablehook__


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


def install(signals: tuple[signal.Signals, ...] = SIGNALS) -> None:
    """Raise `Interrupted` on signals from now on, in the main thread.

    A second SIGTERM changes nothing; a second Ctrl-C also cuts short the cleaning up.
    Once the interpreter shuts down, signals change nothing any more.
    """
    global _received, _hook
    if threading.current_thread() is not threading.main_thread():
        return
    _received = None
    for number in signals:
        signal.signal(number, _raise)
    if sys.unraisablehook is not _again:
        _hook, sys.unraisablehook = sys.unraisablehook, _again
    atexit.register(ignore)


def uninstall() -> None:
    """Have signals do again what they do in every Python program."""
    if sys.unraisablehook is _again:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        sys.unraisablehook = _hook
        atexit.unregister(ignore)


def ignore() -> None:
    """Ignore SIGINT and SIGTERM from now on."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _raise(number: int, frame: FrameType | None) -> None:
    """End the children, so that nobody waits for them, and raise."""
    global _received, _since
    if _received is None:
        _since = time.monotonic()
    _received = number
    if _importing(frame):
        if time.monotonic() - _since > IMPORT_SECONDS:
            end_now(number)
        _later(RETRY_SECONDS, _send_again, number)
        return
    if number == signal.SIGTERM:
        signal.signal(number, signal.SIG_IGN)
    _stop(_children(), "terminate")
    raise Interrupted(number)


def end_now(number: int) -> NoReturn:
    """End this process and its children at once, with the line that says so."""
    end_children()
    show_cursor = b"\x1b[?25h" if os.isatty(2) else b""
    os.write(2, show_cursor + f"\nphysgnn: {name_of(number)}\n".encode())
    os._exit(128 + number)


def _importing(frame: FrameType | None) -> bool:
    """Whether a module is being imported: an exception there may crash native code."""
    while frame is not None:
        if frame.f_code.co_filename == IMPORTER:
            return True
        frame = frame.f_back
    return False


def _again(unraisable: Any) -> None:
    """Raise anew what was lost in a destructor or a callback of the interpreter.

    From another thread, since what is raised in here would be lost, too. Other errors
    of destructors, such as that of an archive that was cut short, follow from a signal
    if there was one, and are no news.
    """
    if not isinstance(unraisable.exc_value, Interrupted):
        if _received is None:
            _hook(unraisable)
        return
    _later(RETRY_SECONDS, _send_again, unraisable.exc_value.number)


def _send_again(number: int) -> None:
    os.kill(os.getpid(), number)


def end_children() -> None:
    """End every process that this one started, and theirs; kill those that stay."""
    import psutil

    children = _children()
    for how in ("terminate", "kill"):
        _stop(children, how)
        _, children = psutil.wait_procs(children, timeout=PATIENCE_SECONDS / 2)


def _children() -> list[Any]:
    """Return the processes below this one, but for Python's tracker of shared memory.

    The tracker ends with this process, after it has removed what is left over.
    """
    import psutil

    found = []
    for child in psutil.Process().children(recursive=True):
        with suppress(psutil.Error):
            if "resource_tracker" not in " ".join(child.cmdline()):
                found.append(child)
    return found


def _stop(processes: list[Any], how: str) -> None:
    import psutil

    for process in processes:
        with suppress(psutil.Error):
            getattr(process, how)()


def end_soon(code: int) -> None:
    """End this process after a while, even if a thread does not."""
    _later(PATIENCE_SECONDS, os._exit, code)


def _later(seconds: float, act: Callable[..., object], *values: int) -> None:
    timer = threading.Timer(seconds, act, values)
    timer.daemon = True
    timer.start()
