"""How far this process grows while something is done."""

import threading
from types import TracebackType
from typing import Self

import psutil

from physgnn.freed_memory import give_back

EVERY_SECONDS = 0.02


class PeakMemory:
    """Looks every 20 ms at the process's resident memory; a context manager.

    Memory that was free in the process goes back to the system first, where the C
    library can do that: what is used again counts. What others still keep does not, and
    neither does a peak shorter than the interval.

    Attributes
    ----------
    mb : float
        The most beyond where it was at the beginning, 10⁶ bytes.
    """

    def __init__(self) -> None:
        self.mb = 0.0
        self._process = psutil.Process()
        self._before = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Self:
        give_back()
        self._before = self._resident()
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        self._thread.join()
        self._look()

    def _watch(self) -> None:
        while not self._over.wait(EVERY_SECONDS):
            self._look()

    def _look(self) -> None:
        self.mb = max(self.mb, (self._resident() - self._before) / 1e6)

    def _resident(self) -> int:
        return int(self._process.memory_info().rss)
