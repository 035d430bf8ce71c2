"""An LSTM's steps on a block of rows, and the backward pass through them.

A step is one matrix product, of the rows' inputs and hidden states side by side, and
one compiled pass over what comes out.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from physgnn.learning.cpu.blocks import Block, States
from physgnn.learning.cpu.kernels import Gradients, State, copy_rows, step, step_back
from physgnn.learning.cpu.lstm_inputs import Array, Given, StepWeights, as_array


class Found(NamedTuple):
    """What an LSTM finds in a block of rows, or the gradients of that.

    Attributes
    ----------
    scores : (steps, rows) array
    end : two (rows, size) arrays or None
        Hidden state and cell at the end, if they're wanted.
    """

    scores: Array
    end: tuple[Array, Array] | None = None


def read(
    block: Block,
    given: Given[Array],
    weights: StepWeights,
    states: States,
    found: Found,
    *,
    back: bool,
) -> None:
    """Fill in a block's states and what is to be found.

    Parameters
    ----------
    block : Block
        Which rows.
    given : Given
        Of these rows.
    weights : StepWeights
        The matrix in the precision of the products.
    states : States
        Room for gates and cells.
    found : Found
        Room for the results.
    back : bool
        Leave in the states what the backward pass needs.
    """
    inputs = _start(block, given, weights)
    rows, width = as_array(inputs), weights.width
    for k in range(block.first, block.end):
        part = weights.at(k, own=k < block.end_of_own)
        if k < block.end_of_own:
            copy_rows(given.own[k], rows[:, :width])
        gates = states.gates[k - block.first]
        torch.mm(inputs[:, part.columns], part.matrix.t(), out=gates)
        step(
            as_array(gates),
            _bias(block, given, weights, k),
            weights.score,
            State(*_cells(block, given, states, k), rows),
            found.scores[k],
            back,
        )
    if found.end:
        copy_rows(rows[:, width:], found.end[0])
        copy_rows(as_array(states.cells[-1]), found.end[1])


class Back(NamedTuple):
    """Gradients of a block's results, and those to be found, which are added to."""

    found: Found
    given: Given[Array]
    weights: StepWeights


def read_back(
    block: Block, given: Given[Array], weights: StepWeights, states: States, of: Back
) -> None:
    """Take a block's gradients back, from what `read` found to what it was given."""
    inputs, width = _start(block, given, weights), weights.width
    rows = as_array(inputs)
    of_inputs, of_cell = _end(inputs, states, of.found)
    after: Tensor | None = None  # gradient of the products of the step after
    for k in reversed(range(block.first, block.end)):
        gates = states.gates[k - block.first]
        of_gates, of_bias = torch.empty_like(gates), _bias(block, *of[1:], k)
        to = *map(as_array, (of_inputs, of_cell, of_gates)), of_bias, of.weights.score
        step_back(
            as_array(gates),
            weights.score,
            State(*_cells(block, given, states, k), rows),
            of.found.scores[k],
            Gradients(*to),
        )
        if after is not None:  # now that the hidden state before it is there
            _add_product(of.weights, block, k + 1, after, inputs)
        own = k < block.end_of_own
        of_inputs = of_gates @ weights.at(k, own=own).matrix
        after = of_gates
        if own:
            copy_rows(given.own[k], rows[:, :width])
            copy_rows(as_array(of_inputs)[:, :width], of.given.own[k])
    if given.start and of.given.start:
        copy_rows(given.start[0], rows[:, width:])
        of_hidden, of_cell_before = map(torch.from_numpy, of.given.start)
        of_hidden += of_inputs[:, -weights.size :]
        of_cell_before += of_cell
    assert after is not None
    _add_product(of.weights, block, block.first, after, inputs)


def _add_product(
    of_weights: StepWeights, block: Block, k: int, of_gates: Tensor, inputs: Tensor
) -> None:
    """Add to the gradient of the matrix; in float32, whatever the products are in."""
    part = of_weights.at(k, own=k < block.end_of_own)
    to, of_gates, inputs = part.matrix, of_gates.t(), inputs[:, part.columns]
    if to.dtype == inputs.dtype:
        to.addmm_(of_gates, inputs)
    else:
        to += of_gates @ inputs


def _start(block: Block, given: Given[Array], weights: StepWeights) -> Tensor:
    """Return room for inputs and hidden states side by side, with the first ones."""
    matrix = weights.own.matrix
    # Zeros: bfloat16 products on some processors read what no step has written yet, and
    # 0 · NaN is NaN.
    inputs = matrix.new_zeros(len(block), matrix.shape[1])
    if given.start:
        copy_rows(given.start[0], as_array(inputs)[:, weights.width :])
    return inputs


def _end(inputs: Tensor, states: States, of: Found) -> tuple[Tensor, Tensor]:
    """Return the gradients of the last hidden states, beside inputs, and cells."""
    of_inputs, of_cell = torch.zeros_like(inputs), torch.zeros_like(states.cells[0])
    if of.end:
        of_inputs[:, -of_cell.shape[1] :] = torch.from_numpy(of.end[0])
        of_cell.copy_(torch.from_numpy(of.end[1]))
    return of_inputs, of_cell


def _bias(block: Block, given: Given[Array], weights: StepWeights, k: int) -> Array:
    """Return what is added to the products: on every row the same, or one a row."""
    if k < block.end_of_own:
        return weights.at(k, own=True).bias
    products = given.products[k]
    assert products is not None
    return products


def _cells(
    block: Block, given: Given[Array], states: States, k: int
) -> tuple[Array, Array]:
    """Return the cells before a step (any, if it's the first) and after it."""
    cell = before = as_array(states.cells[k - block.first])
    if k > block.first:
        before = as_array(states.cells[k - block.first - 1])
    elif given.start:
        before = given.start[1]
    return before, cell
