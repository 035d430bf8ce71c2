"""Scores from an LSTM that reads short sequences, one a row, on the processor.

Rows are taken in blocks small enough to stay in cache, and shared out over threads.
For training only gates and cells are kept, and the backward pass is written out.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.learning.cpu.block_steps import Back, Found, read, read_back
from physgnn.learning.cpu.blocks import Block, Layout, blocks_of
from physgnn.learning.cpu.lstm_inputs import (
    Array,
    Given,
    StepWeights,
    Weights,
    arrays_of,
    as_array,
    blank_like,
)
from physgnn.learning.cpu.threads import n_threads, side_by_side


class Way(NamedTuple):
    """How to compute.

    Attributes
    ----------
    precision : torch.dtype or None
        Of the products: bfloat16, or else the weights'.
    keep : bool
        Keep gates and cells for the backward pass, or compute them again then.
    """

    precision: torch.dtype | None = None
    keep: bool = True


PLAIN = Way()


def lstm(
    given: Given[Tensor], weights: Weights, way: Way, *, end: bool = False
) -> tuple[Tensor, ...]:
    """Read sequences and score the hidden state after every step.

    Parameters
    ----------
    given : Given
        The sequences. Steps that samples have in common at a point are the first ones,
        which the start covers, or the last ones.
    weights : Weights
        The LSTM.
    way : Way
        How to compute.
    end : bool
        Return the state after the last step as well.

    Returns
    -------
    scores : (steps, batch, n) tensor
        0 for steps before the start.
    hidden, cell : (batch, n, size) tensors
        If asked for.
    """
    dtype = way.precision or weights.matrix.dtype
    way = Way(dtype, way.keep and torch.is_grad_enabled())
    found: tuple[Tensor, ...]
    found = _LSTM.apply(way, end, *weights, *given.flat())  # type: ignore[no-untyped-call]
    return found


class _LSTM(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, way: Way, end: bool, *tensors: Any) -> tuple[Tensor, ...]:
        reading = Reading(tensors, way)
        found = reading.room(end)
        kept = _buffer(reading.n_bytes) if way.keep else None
        side_by_side(partial(reading.ahead, kept, _arrays(found)), reading.parts)
        ctx.save_for_backward(*tensors, kept)
        ctx.way = way
        return found

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *grads: Tensor) -> tuple[Any, ...]:
        *tensors, kept = ctx.saved_tensors
        reading = Reading(tensors, ctx.way)
        of_found = tuple(grad.contiguous() for grad in grads)
        of_given = blank_like(reading.given)
        parts = side_by_side(
            partial(reading.back, kept, _arrays(of_found), arrays_of(of_given)),
            reading.parts,
        )
        of_weights = (sum(tensors) for tensors in zip(*parts, strict=True))
        return None, None, *of_weights, *of_given.flat()


class Reading:
    """What is read, cut into blocks."""

    def __init__(self, tensors: Sequence[Any], way: Way) -> None:
        tensors = [None if x is None else x.detach() for x in tensors]
        weights = Weights(*tensors[:3])
        dtype = way.precision or weights.matrix.dtype
        self.weights = weights._replace(matrix=weights.matrix.to(dtype))
        self.by_step = StepWeights.of(self.weights)
        self.given: Given[Tensor] = Given.of(tensors[3:])
        self.arrays = arrays_of(self.given)
        self.layout = Layout(weights.size, dtype, weights.bias.dtype)
        self.batch = len(self.given.own[0])
        self.parts, self.n_bytes = blocks_of(
            self.given.counts, self.batch, self.layout, n_threads()
        )

    def room(self, end: bool) -> tuple[Tensor, ...]:
        """Return room for scores and, if wanted, the state at the end."""
        shape = self.batch, max(self.given.counts)
        like, size = self.weights.bias, self.weights.size
        scores = like.new_zeros(len(self.given.own), *shape)
        return scores, *(like.new_empty(*shape, size) for _ in range(2 * end))

    def ahead(
        self, kept: Tensor | None, found: Sequence[Array], part: Sequence[Block]
    ) -> None:
        """Read some blocks."""
        room = self._scratch(part) if kept is None else kept
        for block in part:
            states = self.layout.states(
                room, block, 0 if kept is None else block.offset
            )
            given, here = self.arrays.on(block), _on(block, found)
            read(block, given, self.by_step, states, here, back=kept is not None)

    def back(
        self,
        kept: Tensor | None,
        of_found: Sequence[Array],
        of_given: Given[Array],
        part: Sequence[Block],
    ) -> Weights:
        """Return the weights' gradient by some blocks; fill in that of the given."""
        like = self.weights.bias.dtype
        of_weights = Weights(*(torch.zeros_like(w, dtype=like) for w in self.weights))
        of_steps = StepWeights.of(of_weights)
        room = self._scratch(part) if kept is None else kept
        for block in part:
            states = self.layout.states(
                room, block, 0 if kept is None else block.offset
            )
            given, of_here = self.arrays.on(block), _on(block, of_found)
            if kept is None:
                here = Found(np.empty_like(of_here.scores))
                read(block, given, self.by_step, states, here, back=True)
            of = Back(of_here, of_given.on(block), of_steps)
            read_back(block, given, self.by_step, states, of)
        return of_weights

    def _scratch(self, part: Sequence[Block]) -> Tensor:
        """Return room for the states of one block after another."""
        return _buffer(max(self.layout.n_bytes(block) for block in part))


def _buffer(n_bytes: int) -> Tensor:
    return torch.empty(n_bytes, dtype=torch.uint8)


def _arrays(tensors: Sequence[Tensor]) -> Sequence[Array]:
    return [as_array(tensor.detach()) for tensor in tensors]


def _on(block: Block, found: Sequence[Array]) -> Found:
    scores, *state = found
    hidden, cell = (x[block.place] for x in state) if state else (None, None)
    end = None if hidden is None or cell is None else (hidden, cell)
    return Found(scores[:, block.sample, block.rows], end)
