"""Blocks of rows that an LSTM reads at once, and where it keeps what it finds."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import torch
from torch import Tensor

ALIGNMENT = 64  # bytes: a cache line
ROWS_A_BLOCK = 512
FEWEST_ROWS = 128  # smaller blocks take longer a row


class Block(NamedTuple):
    """Some points of one sample that have the same steps to themselves.

    Attributes
    ----------
    sample : int
        Which sample.
    rows : slice
        Which points.
    first, end_of_own, end : int
        Steps before the first have been read, those from the end of its own on are the
        same for all samples, and then there's the end.
    offset : int
        Where its states are, bytes.
    """

    sample: int
    rows: slice
    first: int
    end_of_own: int
    end: int
    offset: int

    @property
    def place(self) -> tuple[int, slice]:
        """Sample and points, as indices."""
        return self.sample, self.rows

    def __len__(self) -> int:
        length: int = self.rows.stop - self.rows.start
        return length


class States(NamedTuple):
    """What an LSTM finds in a block, by step from the block's first on."""

    gates: list[Tensor]
    cells: list[Tensor]


class Layout(NamedTuple):
    """How the states of blocks lie in a buffer.

    Attributes
    ----------
    size : int
        Of the hidden state.
    products, cells : torch.dtype
        Of gates and of cells.
    """

    size: int
    products: torch.dtype
    cells: torch.dtype

    def n_bytes(self, block: Block) -> int:
        """Return what a block's states take."""
        return sum(n for _, _, n in self._tensors(block))

    def states(self, buffer: Tensor, block: Block, offset: int) -> States:
        """Return the states of a block that begin at an offset of the buffer."""
        states = States([], [])
        seen_as = {dtype: buffer.view(dtype) for dtype in (self.products, self.cells)}
        for columns, dtype, n_bytes in self._tensors(block):
            shape, strides = (len(block), columns), (columns, 1)
            place = offset // dtype.itemsize
            found = seen_as[dtype].as_strided(shape, strides, place)
            (states.cells if columns == self.size else states.gates).append(found)
            offset += n_bytes
        return states

    def _tensors(self, block: Block) -> Iterator[tuple[int, torch.dtype, int]]:
        """Yield the columns, the type and the bytes of each tensor, padded."""
        for k in range(block.first, block.end):
            for columns, dtype in (
                ((4 if k else 3) * self.size, self.products),
                (self.size, self.cells),
            ):
                n_bytes = len(block) * columns * dtype.itemsize
                yield columns, dtype, -(-n_bytes // ALIGNMENT) * ALIGNMENT


@lru_cache(maxsize=64)
def blocks_of(
    counts: tuple[int, ...], batch: int, layout: Layout, n_parts: int
) -> tuple[list[list[Block]], int]:
    """Cut all points of all samples into blocks, shared out evenly over threads.

    All samples of a point are in the same part, so that no two threads add to the same
    gradient of what the samples have in common.

    Parameters
    ----------
    counts : tuple of int
        Points, by step, whose input is each sample's own: the first ones.
    batch : int
        Samples.
    layout : Layout
        Of the states.
    n_parts : int
        Threads.

    Returns
    -------
    parts : lists of Block
    n_bytes : int
        What the states of all blocks take.
    """
    parts: list[list[Block]] = [[] for _ in range(n_parts)]
    work, end = [0] * n_parts, 0  # bytes tell the work as well
    for rows, first, end_of_own in _pieces(counts, n_parts):
        least = work.index(min(work))
        for sample in range(batch):
            block = Block(sample, rows, first, end_of_own, len(counts), end)
            parts[least].append(block)
            end += layout.n_bytes(block)
        work[least] += batch * layout.n_bytes(block)
    return [part for part in parts if part], end


def _pieces(counts: Sequence[int], n_parts: int) -> Iterator[tuple[slice, int, int]]:
    """Yield points that have the same steps to themselves, and these steps.

    If they're enough, as many for every part: all threads will have the same to do.
    """
    for start, stop in pairwise(sorted({0, *counts})):
        own = [k for k, n_own in enumerate(counts) if n_own > start]
        n = -(-(stop - start) // ROWS_A_BLOCK)
        even = -(-n // n_parts) * n_parts
        n = even if stop - start >= even * FEWEST_ROWS else n
        cuts = (start + (stop - start) * k // n for k in range(n + 1))
        for pair in pairwise(cuts):
            yield slice(*pair), own[0], own[-1] + 1
