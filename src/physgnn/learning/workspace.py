"""Memory used again: what training keeps until the way back, what a thread works in.

A batch of the published size keeps a gigabyte. Fresh memory of that size comes from
the system page by page, zeroed: an eighth of a step's time.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from math import prod
from threading import local

import torch
from torch import Tensor
from torch.autograd.graph import increment_version

ALIGNMENT = 64  # bytes: a cache line

_own = local()
_free: ContextVar[list[Tensor] | None] = ContextVar("free", default=None)


@cache
def keep_freed_memory() -> None:
    """Let the C library keep memory that is freed for whoever needs some next.

    glibc keeps up to twice the size of the largest block freed so far, of blocks up to
    32 MB (mallopt(3), M_MMAP_THRESHOLD), so one is freed here. Else what a network
    needs for a prediction is given back to the system after it, and the next begins
    with fresh, zeroed pages: a fourteenth of PhysGNN's time. Elsewhere it does nothing.
    """
    torch.empty(31 * 2**20, dtype=torch.uint8)


@contextmanager
def reused_memory() -> Iterator[None]:
    """Reuse buffers that are given back, until the end of the context."""
    token = _free.set([])
    try:
        yield
    finally:
        _free.reset(token)


def take(n_bytes: int) -> Tensor:
    """Return a buffer, (n_bytes or more,) uint8, of whatever contents."""
    free = _free.get() or []
    large = [k for k, buffer in enumerate(free) if len(buffer) >= n_bytes]
    if large:
        buffer = free.pop(min(large, key=lambda k: len(free[k])))
        increment_version(buffer)  # who still counts on its contents will be told
        return buffer
    if free:  # no more buffers than are ever in use at once
        free.pop()
    return torch.empty(n_bytes, dtype=torch.uint8)


def give_back(buffer: Tensor) -> None:
    """Let others have a buffer that was taken."""
    free = _free.get()
    if free is not None:
        free.append(buffer)


def scratch(n_bytes: int, use: str = "") -> Tensor:
    """Return this thread's own buffer, (n_bytes or more,) uint8, till it asks again.

    There's one for each use.
    """
    kept: dict[str, Tensor] = _own.__dict__.setdefault("buffers", {})
    if use not in kept or len(kept[use]) < n_bytes:
        lines = -(-n_bytes // ALIGNMENT)  # whole ones, to be seen as any type
        with torch.inference_mode(False):  # or only predictions could write to it
            kept[use] = torch.empty(lines * ALIGNMENT, dtype=torch.uint8)
    return kept[use]


def scratch_for(use: str, like: Tensor, *shape: int) -> Tensor:
    """Return a tensor in this thread's own buffer; see `scratch`."""
    if like.device.type != "cpu":
        return like.new_empty(*shape)
    n_bytes = prod(shape) * like.dtype.itemsize
    return scratch(n_bytes, use)[:n_bytes].view(like.dtype).view(*shape)
