"""What an LSTM is given: its weights; inputs and a start, each sample's own or not."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
from torch import Tensor

from physgnn.learning.lstm_blocks import Block


class Weights(NamedTuple):
    """An LSTM's weights, and the vector that makes a score of a hidden state.

    Gates come in the order f, i, g, o, and those of g doubled: see
    :mod:`physgnn.learning.lstm_kernels`.

    Attributes
    ----------
    matrix : (4·size, width + size) tensor
        From input and hidden state, side by side.
    bias : (4·size,) tensor
    score : (size,) tensor
    """

    matrix: Tensor
    bias: Tensor
    score: Tensor

    @property
    def size(self) -> int:
        """Columns of the hidden state."""
        return len(self.score)

    @property
    def width(self) -> int:
        """Columns of the input."""
        return self.matrix.shape[1] - self.size

    def part(self, k: int, *, own: bool) -> tuple[slice, slice]:
        """Return the rows and columns of the matrix that count at a step.

        At rest there is nothing to forget, and no hidden state; where samples have the
        input in common, its product is given.
        """
        if k == 0:
            return slice(self.size, None), slice(self.width)
        return slice(None), slice(0 if own else self.width, None)


class Given(NamedTuple):
    """What an LSTM reads and where it starts; or the gradients of these.

    Attributes
    ----------
    own : (batch, n_k, width) tensors
        By step, the inputs that are each sample's own: those of the first points.
    products : (n − n_k, 4·size) tensors or None
        What matrix and bias make of the input of the other points, which samples have
        in common; None where the start covers it.
    start : two (n − n_0, size) tensors or None
        Hidden state and cell after the steps that samples have in common, where those
        come first. Points before these start from rest.
    """

    own: tuple[Tensor, ...]
    products: tuple[Tensor | None, ...]
    start: tuple[Tensor, Tensor] | None = None

    @property
    def counts(self) -> tuple[int, ...]:
        """Points, by step, whose input is each sample's own."""
        return tuple(x.shape[1] for x in self.own)

    @classmethod
    def of(cls, tensors: Sequence[Any]) -> "Given":
        """Undo `flat`."""
        n = (len(tensors) - 2) // 2
        hidden, cell = tensors[-2:]
        start = None if hidden is None else (hidden, cell)
        return cls(tuple(tensors[:n]), tuple(tensors[n:-2]), start)

    def flat(self) -> tuple[Tensor | None, ...]:
        """Return all of it as one tuple."""
        return (*self.own, *self.products, *(self.start or (None, None)))

    def blank(self) -> "Given":
        """Return room for gradients; those of what samples have in common are 0."""
        common = self.flat()[len(self.own) :]
        zeros = [None if x is None else torch.zeros_like(x) for x in common]
        return Given.of([*map(torch.empty_like, self.own), *zeros])

    def on(self, block: Block) -> "Given":
        """Return the rows of a block."""
        rows, n = block.rows, max(self.counts)

        def common(x: Tensor | None) -> Tensor | None:
            first = n if x is None else n - len(x)
            if x is None or rows.start < first:
                return None
            return x[rows.start - first : rows.stop - first]

        own, rest = self.own, self.flat()[len(self.own) :]
        return Given.of([*(x[block.place] for x in own), *map(common, rest)])
