"""Parts of a computation side by side, one thread each, every operation serial."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import Barrier
from typing import TypeVar

import torch

T = TypeVar("T")
R = TypeVar("R")


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

    return list(_pool(len(parts)).map(alone, parts))


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
