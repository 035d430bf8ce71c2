"""Work on load paths in processes of this machine, over pipes that only they hold.

Every worker process does one path at a time and says when it is done. A path whose
process died goes to another one. No port is opened, so nobody else can send work.
"""

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import connection, get_context, parent_process, resource_tracker
from typing import Any

from physgnn.errors import InputError

Do = Callable[[int], tuple[str, str]]
MOST_DEATHS = 3
"""A path whose process died so often is given up until the next run."""

# Two workers of two threads on two cores take longer than two of one.
ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
}
# A process that hands freed memory back at once pays for it in page faults: a sixth of
# the time of a load path.
KEEP_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(2**30),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
}


def spread(do: Do, paths: list[int], workers: int) -> Iterator[tuple[int, str, str]]:
    """Do paths in worker processes and yield the results as they come.

    Parameters
    ----------
    do : callable
        From a path to how it ended and the error, empty if none. It can be pickled.
    paths : list of int
    workers : int
        How many processes.

    Raises
    ------
    InputError
        What `do` raises of this kind: it is true of every path.
    """
    waiting, died, busy = deque(paths), Counter[int](), dict[Any, _Worker]()
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                worker = _Worker(do)
                busy[worker.pipe] = worker
                worker.give(waiting.popleft())
            for pipe in connection.wait(list(busy)):
                worker = busy[pipe]
                i, result = worker.path, worker.take()
                if result is None:
                    busy.pop(pipe).stop()
                    died[i] += 1
                    if died[i] < MOST_DEATHS:
                        waiting.appendleft(i)
                        continue
                    result = "error", f"its process died {MOST_DEATHS} times"
                elif waiting:
                    worker.give(waiting.popleft())
                else:
                    busy.pop(pipe).stop()
                yield i, *result
    finally:
        for worker in busy.values():
            worker.stop()


class _Worker:
    """A process and the pipe to it."""

    def __init__(self, do: Do) -> None:
        self.path = -1
        context = get_context("spawn")
        self.pipe, far_end = context.Pipe()
        self._process = context.Process(target=_serve, args=(do, far_end), daemon=True)
        with _environment(ONE_THREAD | KEEP_MEMORY), _undisturbed():
            self._process.start()
        far_end.close()

    def give(self, path: int) -> None:
        """Hand over a path; `take` notices if the process has died."""
        self.path = path
        try:
            self.pipe.send(path)
        except OSError:
            return

    def take(self) -> tuple[str, str] | None:
        """Return what the process has to say of its path, None if it died."""
        try:
            result = self.pipe.recv()
        except (EOFError, OSError):
            return None
        if isinstance(result, InputError):
            raise result
        ended, error = result
        return ended, error

    def stop(self) -> None:
        """End the process: what it has written is whole, see `dataset.storage`."""
        self._process.kill()
        self._process.join()
        self.pipe.close()


def _serve(do: Do, pipe: Any) -> None:
    """Do the paths that come through a pipe; end when the parent does."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            path = pipe.recv()
        except EOFError:
            return
        try:
            result: Any = do(path)
        except InputError as error:  # the tool's, and so every path's
            result = error
        except Exception as error:
            result = "error", f"{type(error).__name__}: {error}"
        pipe.send(result)


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Start a process as a whole, and one that Ctrl-C does not reach.

    In a terminal Ctrl-C is for all processes of the command, and it is for the parent
    to end the others. A process inherits which signals are blocked. A signal that comes
    meanwhile is handled afterwards: in between, the process would wait for the rest of
    what it is to do.
    """
    came: list[int] = []
    is_main = threading.current_thread() is threading.main_thread()
    handlers = {
        number: signal.signal(number, lambda it, _: came.append(it))
        for number in (signal.SIGINT, signal.SIGTERM)
        if is_main  # other threads are not interrupted
    }
    try:
        with _blocked(signal.SIGINT):
            yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        for late in came:
            signal.raise_signal(late)


@contextmanager
def _blocked(number: signal.Signals) -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # its own start would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {number})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables, which started processes inherit, for a while."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
