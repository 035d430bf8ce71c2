"""Parts of a computation side by side, one thread each, every operation serial."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from threading import Barrier
from typing import TypeVar

import torch

T = TypeVar("T")
R = TypeVar("R")

_allowed: ContextVar[int | None] = ContextVar("_allowed", default=None)


def n_threads() -> int:
    """Return how many parts to make of a computation."""
    return _allowed.get() or torch.get_num_threads()


@contextmanager
def only_side_by_side() -> Iterator[None]:
    """Let nothing else divide its work: operations outside `side_by_side` are serial.

    Threads that torch divides an operation over wait for the next by spinning, which
    takes the processor from those that read the LSTMs.
    """
    threads = n_threads()
    token = _allowed.set(threads)
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
        _allowed.reset(token)


def side_by_side(work: Callable[[T], R], parts: Sequence[T]) -> list[R]:
    """Return what work makes of each part; gradients aren't recorded.

    Dividing once beats dividing every operation: threads needn't wait for each other.
    """
    if len(parts) < 2:
        return [work(part) for part in parts]
    inference = torch.is_inference_mode_enabled()

    def alone(part: T) -> R:
        with torch.inference_mode(inference), torch.no_grad():
            return work(part)

    others = [_pool(len(parts) - 1).submit(alone, part) for part in parts[1:]]
    with only_side_by_side():
        first = alone(parts[0])
    return [first, *(other.result() for other in others)]


@cache
def _pool(n_threads: int) -> ThreadPoolExecutor:
    threads = torch.get_num_threads()
    pool = ThreadPoolExecutor(n_threads, "part", initializer=_be_serial)
    all_there = Barrier(n_threads)
    list(pool.map(lambda _: all_there.wait(), range(n_threads)))
    torch.set_num_threads(threads)  # what other new threads begin with
    return pool


def _be_serial() -> None:
    torch.get_num_threads()  # asking first: it makes torch settle this thread's number
    torch.set_num_threads(1)
