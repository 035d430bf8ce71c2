"""What an LSTM is given: its weights; inputs and a start, each sample's own or not."""

from collections.abc import Sequence
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.learning.cpu.blocks import Block

Array = NDArray[np.generic]
Rows = TypeVar("Rows", bound=Tensor | Array)


def as_array(tensor: Tensor) -> Array:
    """Return a tensor's memory as an array; bfloat16 as uint16."""
    bits = tensor.view(torch.uint16) if tensor.dtype == torch.bfloat16 else tensor
    array: Array = bits.numpy()
    return array


class Weights(NamedTuple):
    """An LSTM's weights, and the vector that makes a score of a hidden state.

    Gates come in the order f, i, g, o, and those of g doubled: see
    :mod:`physgnn.learning.cpu.kernels`.

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


class InputPart(NamedTuple):
    """What of the weights counts at a step, sharing their memory.

    Attributes
    ----------
    columns : slice
        Of the inputs and hidden states, side by side.
    matrix : (3·size or 4·size, n) tensor
    bias : (1, 3·size or 4·size) array
    """

    columns: slice
    matrix: Tensor
    bias: Array


class StepWeights(NamedTuple):
    """An LSTM's weights as its steps take them, sharing their memory.

    Attributes
    ----------
    width, size : int
        Columns of the input and of the hidden state.
    score : (size,) array
    first : InputPart
        At rest there is nothing to forget, and no hidden state.
    own, common : InputPart
        Of other steps. What samples have in common has its products given.
    """

    width: int
    size: int
    score: Array
    first: InputPart
    own: InputPart
    common: InputPart

    @classmethod
    def of(cls, weights: Weights) -> "StepWeights":
        """Cut an LSTM's weights."""
        width, size = weights.width, weights.size

        def part(rows: slice, columns: slice) -> InputPart:
            bias = as_array(weights.bias)[None, rows]
            return InputPart(columns, weights.matrix[rows, columns], bias)

        every = slice(None)
        return cls(
            width,
            size,
            as_array(weights.score),
            part(slice(size, None), slice(width)),
            part(every, every),
            part(every, slice(width, None)),
        )

    def at(self, k: int, *, own: bool) -> InputPart:
        """Return what counts at a step."""
        if k == 0:
            return self.first
        return self.own if own else self.common


class Given(NamedTuple, Generic[Rows]):
    """What an LSTM reads and where it starts; or the gradients of these.

    Tensors, or arrays that share their memory: those are quicker to take rows of.

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

    own: tuple[Rows, ...]
    products: tuple[Rows | None, ...]
    start: tuple[Rows, Rows] | None = None

    @property
    def counts(self) -> tuple[int, ...]:
        """Points, by step, whose input is each sample's own."""
        return tuple(x.shape[1] for x in self.own)

    @classmethod
    def of(cls, rows: Sequence[Any]) -> "Given[Rows]":
        """Undo `flat`."""
        n = (len(rows) - 2) // 2
        hidden, cell = rows[-2:]
        start = None if hidden is None else (hidden, cell)
        return cls(tuple(rows[:n]), tuple(rows[n:-2]), start)

    def flat(self) -> tuple[Rows | None, ...]:
        """Return all of it as one tuple."""
        return (*self.own, *self.products, *(self.start or (None, None)))

    def on(self, block: Block) -> "Given[Rows]":
        """Return the rows of a block."""
        rows, n = block.rows, max(self.counts)

        def common(x: Rows | None) -> Any:
            first = n if x is None else n - len(x)
            if x is None or rows.start < first:
                return None
            return x[rows.start - first : rows.stop - first]

        own, rest = self.own, self.flat()[len(self.own) :]
        return Given.of([*(x[block.place] for x in own), *map(common, rest)])


def arrays_of(given: Given[Tensor]) -> Given[Array]:
    """Return the arrays that share the memory of what is given."""
    return Given.of([None if x is None else as_array(x) for x in given.flat()])


def blank_like(given: Given[Tensor]) -> Given[Tensor]:
    """Return room for gradients; those of what samples have in common are 0."""
    common = given.flat()[len(given.own) :]
    zeros = [None if x is None else torch.zeros_like(x) for x in common]
    return Given.of([*map(torch.empty_like, given.own), *zeros])
