"""An LSTM's steps on a block of rows, and the way back through them.

A step is one matrix product, of the rows' inputs and hidden states side by side, and
one compiled pass over what comes out.
"""

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.learning.lstm_blocks import Block, States
from physgnn.learning.lstm_data import Given, Weights
from physgnn.learning.lstm_kernels import Gradients, State, step, step_back
from physgnn.learning.workspace import scratch_for


class Found(NamedTuple):
    """What an LSTM finds in a block of rows, or the gradients of that.

    Attributes
    ----------
    scores : (steps, rows) tensor
    end : two (rows, size) tensors or None
        Hidden state and cell at the end, if they're wanted.
    """

    scores: Tensor
    end: tuple[Tensor, Tensor] | None = None


def read(
    block: Block,
    given: Given,
    weights: Weights,
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
    weights : Weights
        The matrix in the precision of the products.
    states : States
        Room for gates and cells.
    found : Found
        Room for the results.
    back : bool
        Leave in the states what the way back needs.
    """
    inputs = _start(block, given, weights)
    for k in range(block.first, block.end):
        own = k < block.end_of_own
        part = weights.part(k, own=own)
        if own:
            inputs[:, : weights.width] = given.own[k]
        gates = states.gates[k - block.first]
        torch.mm(inputs[:, part[1]], weights.matrix[part].t(), out=gates)
        step(
            _array(gates),
            _array(_bias(block, given, weights, k)),
            _array(weights.score),
            _state(block, given, states, k, inputs),
            _array(found.scores[k]),
            back,
        )
    if found.end:
        found.end[0].copy_(inputs[:, weights.width :])
        found.end[1].copy_(states.cells[-1])


class Back(NamedTuple):
    """Gradients of a block's results, and those to be found, which are added to."""

    found: Found
    given: Given
    weights: Weights


def read_back(
    block: Block, given: Given, weights: Weights, states: States, of: Back
) -> None:
    """Take a block's gradients back, from what `read` found to what it was given."""
    inputs = _start(block, given, weights)
    of_inputs, of_cell = _end(inputs, states, of.found)
    after: Tensor | None = None  # gradient of the products of the step after
    for k in reversed(range(block.first, block.end)):
        gates = states.gates[k - block.first]
        of_gates, of_bias = torch.empty_like(gates), _bias(block, *of[1:], k)
        to = (of_inputs, of_cell, of_gates, of_bias, of.weights.score)
        step_back(
            _array(gates),
            _array(weights.score),
            _state(block, given, states, k, inputs),
            _array(of.found.scores[k]),
            Gradients(*map(_array, to)),
        )
        if after is not None:  # now that the hidden state before it is there
            _add_product(of.weights, block, k + 1, after, inputs)
        own = k < block.end_of_own
        of_inputs = of_gates @ weights.matrix[weights.part(k, own=own)]
        after = of_gates
        if own:
            inputs[:, : weights.width] = given.own[k]
            of.given.own[k].copy_(of_inputs[:, : weights.width])
    if given.start and of.given.start:
        inputs[:, weights.width :] = given.start[0]
        of.given.start[0].add_(of_inputs[:, -weights.size :])
        of.given.start[1].add_(of_cell)
    assert after is not None
    _add_product(of.weights, block, block.first, after, inputs)


def _add_product(
    of_weights: Weights, block: Block, k: int, of_gates: Tensor, inputs: Tensor
) -> None:
    """Add to the gradient of the matrix; in float32, whatever the products are in."""
    part = of_weights.part(k, own=k < block.end_of_own)
    to, of_gates, inputs = of_weights.matrix[part], of_gates.t(), inputs[:, part[1]]
    if to.dtype == inputs.dtype:
        to.addmm_(of_gates, inputs)
    else:
        to += of_gates @ inputs


def _start(block: Block, given: Given, weights: Weights) -> Tensor:
    """Return this thread's room for inputs and hidden states, with the first ones."""
    matrix = weights.matrix
    inputs = scratch_for("inputs", matrix, len(block), matrix.shape[1])
    if given.start:
        inputs[:, weights.width :] = given.start[0]
    return inputs


def _end(inputs: Tensor, states: States, of: Found) -> tuple[Tensor, Tensor]:
    """Return the gradients of the last hidden states, beside inputs, and cells."""
    of_inputs, of_cell = torch.zeros_like(inputs), torch.zeros_like(states.cells[0])
    if of.end:
        of_inputs[:, -of_cell.shape[1] :] = of.end[0]
        of_cell.copy_(of.end[1])
    return of_inputs, of_cell


def _bias(block: Block, given: Given, weights: Weights, k: int) -> Tensor:
    """Return what is added to the products: on every row the same, or one a row."""
    if k < block.end_of_own:
        return weights.bias[weights.part(k, own=True)[0]][None]
    products = given.products[k]
    assert products is not None
    return products


def _state(block: Block, given: Given, states: States, k: int, inputs: Tensor) -> State:
    cell = before = states.cells[k - block.first]
    if k > block.first:
        before = states.cells[k - block.first - 1]
    elif given.start:
        before = given.start[1]
    return State(_array(before), _array(cell), _array(inputs))


def _array(tensor: Tensor) -> NDArray[np.generic]:
    bits = tensor.view(torch.uint16) if tensor.dtype == torch.bfloat16 else tensor
    array: NDArray[np.generic] = bits.numpy()
    return array
