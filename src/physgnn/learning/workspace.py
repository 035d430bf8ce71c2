"""Memory used again.

What training keeps until the way back, what a thread works in, and what a prediction
hands from layer to layer. A batch of the published size keeps a gigabyte, a prediction
makes ten megabytes. Fresh memory of that size comes from the system page by page,
zeroed: an eighth of a step's time, a twelfth of a prediction's.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from math import prod
from threading import local

import torch
from torch import Tensor
from torch.autograd.graph import increment_version

ALIGNMENT = 64  # bytes: a cache line

_own = local()
_room: ContextVar["Room | None"] = ContextVar("room", default=None)
_free: ContextVar[list[Tensor] | None] = ContextVar("free", default=None)


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
        with torch.inference_mode(False):  # or only predictions could write to it
            kept[use] = torch.empty(n_bytes, dtype=torch.uint8)
    return kept[use]


def scratch_for(use: str, like: Tensor, *shape: int) -> Tensor:
    """Return a tensor in this thread's own buffer; see `scratch`."""
    if like.device.type != "cpu":
        return like.new_empty(*shape)
    n_bytes = prod(shape) * like.dtype.itemsize
    return scratch(n_bytes, use)[:n_bytes].view(like.dtype).view(*shape)


class Room:
    """A buffer that tensors are cut from, one after the other.

    Parameters
    ----------
    n_bytes : int
        Its size.
    """

    def __init__(self, n_bytes: int) -> None:
        self._buffer = torch.empty(n_bytes, dtype=torch.uint8)
        self.asked = 0

    def __len__(self) -> int:
        return len(self._buffer)

    def cut(self, shape: Sequence[int], dtype: torch.dtype) -> Tensor | None:
        """Return a tensor of whatever contents, or None if there's no room left."""
        begin, n_bytes = self.asked, prod(shape) * dtype.itemsize
        self.asked += -(-n_bytes // ALIGNMENT) * ALIGNMENT
        if self.asked > len(self):
            return None
        return self._buffer[begin : begin + n_bytes].view(dtype).view(*shape)


@contextmanager
def room_used_again() -> Iterator[None]:
    """Let `empty` cut from this thread's room; what it gives is lost at the end.

    Not where gradients are wanted: for these all must be kept. The first time there's
    no room, and the next time there's as much as was asked for.
    """
    room: Room | None = getattr(_own, "room", None)
    if room is None or room.asked > len(room):
        with torch.inference_mode(False):
            room = _own.room = Room(room.asked if room else 0)
    room.asked = 0
    token = _room.set(room)
    try:
        yield
    finally:
        _room.reset(token)


def empty(like: Tensor, *shape: int) -> Tensor:
    """Return a tensor of that shape, of whatever contents, else as another is."""
    room = _room.get() if like.device.type == "cpu" else None
    cut = None if room is None else room.cut(shape, like.dtype)
    return like.new_empty(*shape) if cut is None else cut
