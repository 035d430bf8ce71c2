"""Scores from an LSTM that reads short sequences, one a row, by a few matrix products.

Rows are taken in blocks small enough that gates and states stay in cache; for training
only gates and cells are kept, and the way back is written out.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

ROWS_A_BLOCK = 512


class Weights(NamedTuple):
    """An LSTM's weights, and the vector that makes a score of a hidden state.

    Gates come in the order f, i, g, o, and those of g doubled: tanh(z) = 2σ(2z) − 1, so
    that one sigmoid serves all four.

    Attributes
    ----------
    bias : (4·hidden,) tensor
    from_input : (4·hidden, width) tensor
    from_hidden : (4·hidden, hidden) tensor
    score : (hidden,) tensor
    """

    bias: Tensor
    from_input: Tensor
    from_hidden: Tensor
    score: Tensor


class States(NamedTuple):
    """Gates after the sigmoid, and cells, of every step of a block of rows.

    The first step's gates lack f: at rest there is nothing to forget.
    """

    gates: list[Tensor]
    cells: list[Tensor]


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
        weights, sequence = Weights(*tensors[:4]), tensors[4:]
        scores, kept = [], []
        for block in _blocks(sequence):
            states, of_block = _read(block, weights)
            scores.append(of_block)
            if keep:
                kept += [*states.gates, *states.cells]
        ctx.keep, ctx.n_inputs = keep, len(tensors)
        ctx.save_for_backward(*tensors, *kept)
        return torch.cat(scores)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor | None, ...]:
        saved, n_inputs = ctx.saved_tensors, ctx.n_inputs
        weights, sequence = Weights(*saved[:4]), saved[4:n_inputs]
        of_weights = Weights(*map(torch.zeros_like, weights))
        of_inputs = []
        for i, (of_block, *block) in enumerate(_blocks([grad, *sequence])):
            n = len(block)
            kept = saved[n_inputs + 2 * n * i :][: 2 * n]
            states = (
                States(list(kept[:n]), list(kept[n:]))
                if ctx.keep
                else _read(block, weights)[0]
            )
            of_inputs.append(_read_back(block, of_block, states, weights, of_weights))
        of_sequence = (torch.cat(parts) for parts in zip(*of_inputs, strict=True))
        return None, *of_weights, *of_sequence


def _read(sequence: Sequence[Tensor], weights: Weights) -> tuple[States, Tensor]:
    size = len(weights.score)
    states, scores = States([], []), []
    hidden = sequence[0]  # there is none yet
    for k, x in enumerate(sequence):
        rows = slice(0 if k else size, None)  # without f at the first step
        gates = torch.addmm(weights.bias[rows], x, weights.from_input[rows].t())
        if k:
            gates.addmm_(hidden, weights.from_hidden.t())
        states.gates.append(gates.sigmoid_())
        *forget, i, g, _ = _gates(states, k)
        cell = _times_tanh(i, g)
        if forget:
            cell.addcmul_(forget[0], states.cells[k - 1])
        states.cells.append(cell)
        hidden = _hidden(states, k)
        scores.append(hidden @ weights.score)
    return states, torch.stack(scores, dim=1)


def _read_back(
    sequence: Sequence[Tensor],
    of_scores: Tensor,
    states: States,
    weights: Weights,
    of_weights: Weights,
) -> list[Tensor]:
    """Return the gradients of a block's inputs; add to those of the weights."""
    of_inputs: list[Tensor] = []
    before = of_scores  # of the step after, of which there is none yet
    of_hidden: Tensor | None = None
    of_cell: Tensor | None = None
    for k in reversed(range(len(sequence))):
        of_score = of_scores[:, k]
        hidden = _hidden(states, k)
        of_weights.score.addmv_(hidden.t(), of_score)
        if of_hidden is not None:
            of_weights.from_hidden.addmm_(before.t(), hidden)  # of step k + 1
        from_score = torch.outer(of_score, weights.score)
        of_hidden = from_score if of_hidden is None else of_hidden.add_(from_score)
        before, of_cell = _step_back(states, k, of_hidden, of_cell)
        rows = slice(-before.shape[1], None)  # without f at the first step
        of_weights.bias[rows].add_(before.sum(dim=0))
        of_weights.from_input[rows].addmm_(before.t(), sequence[k])
        of_inputs.insert(0, before @ weights.from_input[rows])
        if k:
            of_hidden = before @ weights.from_hidden
    return of_inputs


def _step_back(
    states: States, k: int, of_hidden: Tensor, of_cell: Tensor | None
) -> tuple[Tensor, Tensor | None]:
    """Return the gradients before the gates' sigmoid and of the cell a step earlier."""
    *forget, i, g, o = _gates(states, k)
    tanh = torch.sigmoid(2 * states.cells[k]).mul_(2).sub_(1)
    through = of_hidden * o
    through.addcmul_(through, tanh.square(), value=-1)
    of_cell = through if of_cell is None else through.add_(of_cell)
    of_gates = [of_cell * (2 * g - 1), 2 * of_cell * i, of_hidden * tanh]
    if forget:
        of_gates.insert(0, of_cell * states.cells[k - 1])
    gates = states.gates[k]
    before: Tensor = torch.ops.aten.sigmoid_backward(torch.cat(of_gates, dim=1), gates)
    return before, of_cell * forget[0] if forget else None


def _gates(states: States, k: int) -> tuple[Tensor, ...]:
    return states.gates[k].chunk(4 if k else 3, dim=1)


def _hidden(states: States, k: int) -> Tensor:
    return _times_tanh(_gates(states, k)[-1], torch.sigmoid(2 * states.cells[k]))


def _times_tanh(factor: Tensor, sigmoid_of_twice: Tensor) -> Tensor:
    """Return factor · tanh(z), given σ(2z)."""
    return torch.addcmul(-factor, factor, sigmoid_of_twice, value=2)


def _blocks(rows: Sequence[Tensor]) -> list[tuple[Tensor, ...]]:
    cuts = (torch.split(row, ROWS_A_BLOCK) for row in rows)
    return list(zip(*cuts, strict=True))
