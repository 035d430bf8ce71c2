"""A training that a signal ends passes that on to its caller, and leaves no process.

Lightning would end a Ctrl-C with exit code 1 and a SIGTERM with 0, and would leave the
processes that train together with this one to find out by themselves.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer


class SignalsAsBefore(Callback):
    """Puts the caller's answer to SIGTERM back in the place that Lightning took."""

    def __init__(self) -> None:
        self._before = signal.getsignal(signal.SIGTERM)

    def on_train_start(self, _: Trainer, __: LightningModule) -> None:
        """Put it back; Lightning has just installed its own."""
        if _in_main_thread():
            signal.signal(signal.SIGTERM, self._before)


@contextmanager
def ending_at_signals() -> Iterator[None]:
    """Raise SystemExit(143) on SIGTERM within, unless the caller has an answer to it.

    Afterwards the answers to SIGTERM and SIGINT are those of before.
    """
    if not _in_main_thread():
        yield
        return
    before = {n: signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)}
    if before[signal.SIGTERM] is signal.SIG_DFL:
        signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        for number, answer in before.items():
            signal.signal(number, answer)


@contextmanager
def ending_together(trainer: Trainer) -> Iterator[None]:
    """End the processes that train together with this one if it ends early.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C, which Lightning makes a SystemExit of.
    """
    launcher = trainer.strategy.launcher
    if hasattr(launcher, "procs"):
        _leave_interrupts_to_us(launcher)
    try:
        yield
    except BaseException as error:
        _end(getattr(launcher, "procs", []))
        if isinstance(error, SystemExit) and isinstance(
            error.__context__, KeyboardInterrupt
        ):
            raise KeyboardInterrupt from None
        raise


def _leave_interrupts_to_us(launcher: Any) -> None:
    """Start the other processes so that they ignore Ctrl-C: it goes to all at once.

    A signal that is ignored stays so in a process that is started meanwhile.
    """
    start = launcher._call_children_scripts

    def start_ignoring() -> None:
        if not _in_main_thread():
            start()
            return
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            start()
        finally:
            signal.signal(signal.SIGINT, before)

    launcher._call_children_scripts = start_ignoring


def _end(processes: list[Any]) -> None:
    for process in processes:
        process.kill()
        process.wait()
    # Lightning watches this list, and kills the program once one in it has failed.
    processes.clear()


def _terminate(number: int, _: FrameType | None) -> None:
    raise SystemExit(128 + number)


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
