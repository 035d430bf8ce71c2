"""Work on load paths in processes of this machine, over pipes that only they hold.

Every worker process does one path at a time, or some side by side, and says when one is
done. A path whose process died goes to another one. No port is opened, so nobody else
can send work.
"""

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import connection, get_context, parent_process, resource_tracker
from typing import Any

from physgnn.dataset.generation.abreast import Do
from physgnn.errors import InputError

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
    "MALLOC_ARENA_MAX": "1",  # for all threads: they take turns
}


def spread(
    do: Do, paths: list[int], workers: int, *, most: int = 1
) -> Iterator[tuple[int, str, str]]:
    """Do paths in worker processes and yield the results as they come.

    Parameters
    ----------
    do : callable
        From a path to how it ended and the error, empty if none. It can be pickled.
    paths : list of int
    workers : int
        How many processes.
    most : int
        Paths that each of them does side by side, at most.

    Raises
    ------
    InputError
        What `do` raises of this kind: it is true of every path.
    """
    waiting, died, busy = deque(paths), Counter[int](), dict[Any, _Worker]()
    abreast = min(most, -(-len(paths) // workers))
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                worker = _Worker(do, abreast)
                busy[worker.pipe] = worker
                _fill(worker, waiting, died)
            for pipe in connection.wait(list(busy)):
                worker = busy[pipe]
                result = worker.take()
                if result is None:
                    busy.pop(pipe).stop()
                    yield from _lost(worker, waiting, died)
                    continue
                _fill(worker, waiting, died)
                if not worker.paths:
                    busy.pop(pipe).stop()
                yield result
    finally:
        for worker in busy.values():
            worker.stop()


def _fill(worker: "_Worker", waiting: deque[int], died: Counter[int]) -> None:
    """Give a worker what it may do; a path that may kill it has no company."""
    while waiting and len(worker.paths) < worker.abreast:
        if worker.paths and any(died[i] for i in (*worker.paths, waiting[0])):
            return
        worker.give(waiting.popleft())


def _lost(
    worker: "_Worker", waiting: deque[int], died: Counter[int]
) -> Iterator[tuple[int, str, str]]:
    """Put back what a dead worker was at; yield what is given up."""
    for i in worker.paths:
        died[i] += 1
        if died[i] < MOST_DEATHS:
            waiting.appendleft(i)
        else:
            yield i, "error", f"its process died {MOST_DEATHS} times"


class _Worker:
    """A process and the pipe to it."""

    def __init__(self, do: Do, abreast: int) -> None:
        self.paths, self.abreast = list[int](), abreast
        context = get_context("spawn")
        self.pipe, far_end = context.Pipe()
        self._process = context.Process(
            target=_serve, args=(do, abreast, far_end), daemon=True
        )
        with _environment(ONE_THREAD | KEEP_MEMORY), _undisturbed():
            self._process.start()
        far_end.close()

    def give(self, path: int) -> None:
        """Hand over a path; `take` notices if the process has died."""
        self.paths.append(path)
        try:
            self.pipe.send(path)
        except OSError:
            return

    def take(self) -> tuple[int, str, str] | None:
        """Return what the process has to say of a path, None if it died."""
        try:
            path, result = self.pipe.recv()
        except (EOFError, OSError):
            return None
        if isinstance(result, InputError):
            raise result
        self.paths.remove(path)
        return path, *result

    def stop(self) -> None:
        """End the process: what it has written is whole, see `dataset.storage`."""
        self._process.kill()
        self._process.join()
        self.pipe.close()


def _serve(do: Do, abreast: int, pipe: Any) -> None:
    """Do the paths that come through a pipe; end when the parent does."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    one_at_a_time = threading.Lock()

    def answer(path: int) -> None:
        try:
            result: Any = do(path)
        except InputError as error:  # the tool's, and so every path's
            result = error
        except Exception as error:
            result = "error", f"{type(error).__name__}: {error}"
        with one_at_a_time:
            pipe.send((path, result))

    with ThreadPoolExecutor(abreast) as threads:
        while True:
            try:
                path = pipe.recv()
            except EOFError:
                return
            threads.submit(answer, path)


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
