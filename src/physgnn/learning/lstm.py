"""Scores from an LSTM that reads short sequences, one a row, on the processor.

A step is one matrix product, of the row's input and hidden state side by side, and one
compiled pass over what comes out. Rows are taken in blocks small enough to stay in
cache, and shared out over threads; for training only gates and cells are kept, and the
way back is written out.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.lstm_kernels import Gradients, State, step, step_back
from physgnn.learning.threads import side_by_side

ROWS_A_BLOCK = 512


class Weights(NamedTuple):
    """An LSTM's weights, and the vector that makes a score of a hidden state.

    Gates come in the order f, i, g, o, and those of g doubled: see
    :mod:`physgnn.learning.lstm_kernels`.

    Attributes
    ----------
    matrix : (4·hidden, width + hidden) tensor
        From input and hidden state. Its precision is that of the products: bfloat16
        if there's no way back.
    bias : (4·hidden,) tensor
    score : (hidden,) tensor
    """

    matrix: Tensor
    bias: Tensor
    score: Tensor

    @property
    def width(self) -> int:
        """Columns of the input."""
        return self.matrix.shape[1] - len(self.score)

    def of_step(self, k: int) -> tuple[Tensor, Tensor]:
        """Return matrix and bias; at rest there is nothing to forget, nor hidden."""
        if k:
            return self.matrix, self.bias
        first = len(self.score)
        return self.matrix[first:, : self.width], self.bias[first:]


class Rows(NamedTuple):
    """Sequences, and what an LSTM makes of them: by step, one row a sequence."""

    sequence: Sequence[Tensor]
    gates: Sequence[Tensor]
    cells: Sequence[Tensor]

    def cut(self, rows: slice) -> "Rows":
        """Return some of the rows."""
        return Rows(*([tensor[rows] for tensor in steps] for steps in self))

    @classmethod
    def blank(cls, sequence: Sequence[Tensor], weights: Weights) -> "Rows":
        """Return room for gates and cells."""
        n, size = len(sequence[0]), len(weights.score)
        like = weights.matrix
        gates = [
            like.new_empty(n, len(weights.of_step(k)[1])) for k in _steps(sequence)
        ]
        cells = [weights.bias.new_empty(n, size) for _ in sequence]
        return cls(sequence, gates, cells)


def lstm_scores(
    sequence: Sequence[Tensor], weights: Weights, *, keep: bool = True
) -> Tensor:
    """Read a sequence from rest and score the hidden state after every step.

    Parameters
    ----------
    sequence : sequence of (n, width) tensors
        What n sequences have at each step.
    weights : Weights
        The LSTM.
    keep : bool
        Keep gates and cells for the backward pass, or compute them again then.

    Returns
    -------
    (n, steps) tensor
    """
    kept = keep and torch.is_grad_enabled()
    scores: Tensor = _Scores.apply(kept, *weights, *sequence)  # type: ignore[no-untyped-call]
    return scores


class _Scores(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, keep: bool, *tensors: Tensor) -> Tensor:
        weights, sequence = Weights(*tensors[:3]), tensors[3:]
        scores = weights.bias.new_empty(len(sequence[0]), len(sequence))
        kept = Rows.blank(sequence, weights) if keep else None

        def read(part: slice) -> None:
            for block, rows in _blocks(sequence, weights, kept, part):
                _read(rows, weights, scores[block])

        side_by_side(read, _parts(len(scores)))
        ctx.save_for_backward(*tensors, *([*kept.gates, *kept.cells] if kept else ()))
        ctx.n_inputs = len(tensors)
        return scores

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor | None, ...]:
        saved, n = ctx.saved_tensors, ctx.n_inputs
        weights, sequence, states = Weights(*saved[:3]), saved[3:n], saved[n:]
        half = len(states) // 2
        kept = Rows(sequence, states[:half], states[half:]) if states else None
        of_sequence = [torch.empty_like(x) for x in sequence]
        grad = grad.contiguous()

        def read_back(part: slice) -> Weights:
            of_weights = Weights(*map(torch.zeros_like, weights))
            for block, rows in _blocks(sequence, weights, kept, part):
                if kept is None:
                    _read(rows, weights, torch.empty_like(grad[block]))
                inputs = _read_back(rows, weights, grad[block], of_weights)
                for of_x, of_input in zip(of_sequence, inputs, strict=True):
                    of_x[block] = of_input
            return of_weights

        parts = side_by_side(read_back, _parts(len(grad)))
        return (
            None,
            *(sum(tensors) for tensors in zip(*parts, strict=True)),
            *of_sequence,
        )


def _read(rows: Rows, weights: Weights, scores: Tensor) -> None:
    """Fill in gates, cells and scores."""
    inputs = weights.matrix.new_empty(len(scores), weights.matrix.shape[1])
    for k, x in enumerate(rows.sequence):
        matrix, bias = weights.of_step(k)
        inputs[:, : weights.width] = x
        gates = rows.gates[k]
        torch.mm(inputs[:, : matrix.shape[1]], matrix.t(), out=gates)
        state = _state(rows, k, inputs)
        step(
            _array(gates),
            _array(bias),
            _array(weights.score),
            state,
            _array(scores[:, k]),
        )


def _read_back(
    rows: Rows, weights: Weights, of_scores: Tensor, of_weights: Weights
) -> list[Tensor]:
    """Return the gradients of a block's inputs; add to those of the weights."""
    inputs = torch.empty(len(of_scores), weights.matrix.shape[1]).to(weights.bias)
    of_inputs, of_cell = torch.zeros_like(inputs), torch.zeros_like(rows.cells[0])
    of_sequence: list[Tensor] = []
    after: Tensor | None = None  # gradient of the products of the step after
    for k in reversed(_steps(rows.sequence)):
        matrix, _ = weights.of_step(k)
        of_matrix, of_bias = of_weights.of_step(k)
        of_gates = torch.empty_like(rows.gates[k])
        gradients = Gradients(
            *map(_array, (of_inputs, of_cell, of_gates, of_bias, of_weights.score))
        )
        step_back(
            _array(rows.gates[k]),
            _array(weights.score),
            _state(rows, k, inputs),
            _array(of_scores[:, k]),
            gradients,
        )
        if after is not None:  # now that the hidden state before it is there
            of_weights.matrix.addmm_(after.t(), inputs)
        inputs[:, : weights.width] = rows.sequence[k]
        of_inputs = of_gates @ matrix
        of_sequence.insert(0, of_inputs[:, : weights.width])
        after = of_gates
    of_matrix.addmm_(of_gates.t(), inputs[:, : weights.width])
    return of_sequence


def _state(rows: Rows, k: int, inputs: Tensor) -> State:
    before, cell = rows.cells[max(k - 1, 0)], rows.cells[k]
    return State(_array(before), _array(cell), _array(inputs))


def _blocks(
    sequence: Sequence[Tensor], weights: Weights, kept: Rows | None, part: slice
) -> Iterator[tuple[slice, Rows]]:
    """Yield blocks of a part: with what is kept of them, or with room used again."""
    room = None
    for start in range(part.start, part.stop, ROWS_A_BLOCK):
        block = slice(start, min(start + ROWS_A_BLOCK, part.stop))
        if kept is not None:
            yield block, kept.cut(block)
            continue
        rows = [x[block] for x in sequence]
        room = room or Rows.blank(rows, weights)
        yield block, room.cut(slice(len(rows[0])))._replace(sequence=rows)


def _parts(n_rows: int) -> list[slice]:
    """Return a part for every thread, none much smaller than a block."""
    n = max(1, min(torch.get_num_threads(), n_rows // (ROWS_A_BLOCK // 2)))
    cuts = [n_rows * k // n for k in range(n + 1)]
    return [slice(*pair) for pair in pairwise(cuts)]


def _steps(sequence: Sequence[Tensor]) -> range:
    return range(len(sequence))


def _array(tensor: Tensor) -> NDArray[np.generic]:
    bits = tensor.view(torch.uint16) if tensor.dtype == torch.bfloat16 else tensor
    array: NDArray[np.generic] = bits.detach().numpy()
    return array
