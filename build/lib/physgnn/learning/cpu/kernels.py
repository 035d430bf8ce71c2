"""An LSTM between its matrix products: one pass over gates and states, compiled.

Gates come in the order f, i, g, o, or without f at the first step, where there is
nothing to forget. Products for g are doubled: tanh(z) = 2σ(2z) − 1, so that one sigmoid
serves all. Numbers are float32 or float64; products and hidden states may also be
bfloat16, seen as uint16.
"""

# ruff: noqa: ARG001, ARG005
# Numba picks a variant for its arguments' types, and all must have the same arguments.

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

# Sums in any order, no care for what isn't finite: else nothing is vectorised.
FAST = {"contract", "reassoc", "nsz", "arcp"}
compiled = njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")


class State(NamedTuple):
    """Where an LSTM is after a step; arrays, one row a sequence.

    Attributes
    ----------
    before, cell : (n, size) arrays
        Cells a step earlier (not read if there's no f), and now.
    inputs : (n, width + size) array
        Its last columns take the hidden states.
    """

    before: Any
    cell: Any
    inputs: Any


class Gradients(NamedTuple):
    """What the backward pass carries.

    Attributes
    ----------
    inputs : (n, size or more) array
        Its last columns are those of the hidden states by the step after.
    cell : (n, size) array
        By the step after; then, for the step before.
    gates : (n, 3·size or 4·size) array
        Of the products: the result.
    bias, score : arrays
        Added to.
    """

    inputs: Any
    cell: Any
    gates: Any
    bias: Any
    score: Any


@compiled
def step(gates, bias, score, state, scores, back):  # type: ignore[no-untyped-def]
    """Make gates of products, in place; find cells, hidden states and their scores.

    Parameters
    ----------
    gates : (n, 3·size or 4·size) array
        In: products without bias. Out: gates.
    bias : (1 or n, 3·size or 4·size) array
        Added to them.
    score : (size,) array
        Makes a score of a hidden state.
    state : State
        Its cells and hidden states are found.
    scores : (n,) array
        Out.
    back : bool
        Whether a backward pass follows, which needs the gates.
    """
    before, cell, inputs = state
    n, m = cell.shape
    scratch = np.empty(gates.shape[1], cell.dtype)
    for row in range(n):
        z, b = floats(gates[row], scratch), bias[min(row, len(bias) - 1)]
        for j in range(len(z)):
            z[j] = sigmoid(z[j] + b[j])
        i, g, o = _last_three(z, m)
        c, h = cell[row], inputs[row, inputs.shape[1] - m :]
        for j in range(m):
            c[j] = i[j] * twice(g[j]) - i[j]
        if len(z) > 3 * m:
            f, old = z[:m], before[row]
            for j in range(m):
                c[j] += f[j] * old[j]
        total = cell.dtype.type(0)
        for j in range(m):
            hidden = o[j] * twice(sigmoid(twice(c[j]))) - o[j]
            h[j] = rounded(hidden, h)
            total += hidden * score[j]
        scores[row] = total
        if back:
            keep(z, gates[row])


@compiled
def step_back(gates, score, state, of_scores, of):  # type: ignore[no-untyped-def]
    """Take gradients back through a step; find its hidden states again.

    Parameters
    ----------
    gates : (n, 3·size or 4·size) array
        As `step` left them.
    score : (size,) array
        As in `step`.
    state : State
        Its cells are read, its hidden states found.
    of_scores : (n,) array
        The scores' gradient.
    of : Gradients
        See there.
    """
    before, cell, inputs = state
    n, m = cell.shape
    one = cell.dtype.type(1)
    scratch = np.empty(gates.shape[1], cell.dtype)
    scratch_back = np.empty(gates.shape[1], cell.dtype)
    tanh, hidden = np.empty(m, cell.dtype), np.empty(m, cell.dtype)
    to_h = np.empty(m, cell.dtype)
    first = inputs.shape[1] - m
    for row in range(n):
        z, by_score = floats(gates[row], scratch), of_scores[row]
        to = room_for(of.gates[row], scratch_back)
        i, g, o = _last_three(z, m)
        to_i, to_g, to_o = _last_three(to, m)
        c, to_c = cell[row], of.cell[row]
        after = floats(of.inputs[row, of.inputs.shape[1] - m :], to_h)
        for j in range(m):
            tanh[j] = twice(sigmoid(twice(c[j]))) - one
        for j in range(m):
            hidden[j] = o[j] * tanh[j]
        for j in range(m):
            of.score[j] += by_score * hidden[j]
        for j in range(m):
            to_h[j] = after[j] + by_score * score[j]
        for j in range(m):
            to_c[j] += to_h[j] * o[j] * (one - tanh[j] * tanh[j])
        for j in range(m):
            to_o[j] = to_h[j] * hidden[j] * (one - o[j])
        for j in range(m):
            to_g[j] = twice(to_c[j] * i[j] * g[j] * (one - g[j]))
        for j in range(m):
            to_i[j] = to_c[j] * (twice(g[j]) - one) * i[j] * (one - i[j])
        if len(z) > 3 * m:
            f, old, to_f = z[:m], before[row], to[:m]
            for j in range(m):
                to_f[j] = to_c[j] * old[j] * f[j] * (one - f[j])
            for j in range(m):
                to_c[j] *= f[j]
        of_bias = of.bias[min(row, len(of.bias) - 1)]
        for j in range(len(to)):
            of_bias[j] += to[j]
        keep(to, of.gates[row])
        put(hidden, inputs[row, first:])


@compiled
def copy_rows(values, where):  # type: ignore[no-untyped-def]
    """Copy rows of (n, columns), rounded or widened as the others are."""
    scratch = np.empty(values.shape[1], np.float32)
    for row in range(len(values)):
        put(floats(values[row], scratch), where[row])


@njit(inline="always")
def twice(x: Any) -> Any:
    """Return 2x without the float64 that a literal 2 would make of float32."""
    return x + x


@compiled
def _last_three(z: Any, m: Any) -> Any:
    first = len(z) - 3 * m
    return z[first : first + m], z[first + m : first + 2 * m], z[first + 2 * m :]


def sigmoid(z: Any) -> Any:
    """Return 1 / (1 + exp(−z)); compiled only."""


def floats(values: Any, scratch: Any) -> Any:
    """Return bfloat16 values in a scratch array, others as they are; compiled only."""


def room_for(values: Any, scratch: Any) -> Any:
    """Return a scratch array for bfloat16 values, others as they are; compiled only."""


def keep(values: Any, where: Any) -> None:
    """Put values that are in a scratch array where they belong; compiled only."""


def put(values: Any, where: Any) -> None:
    """Copy values, rounded as the array's elements are; compiled only."""


def rounded(value: Any, where: Any) -> Any:
    """Return a value as the array's elements are; compiled only."""


@overload(sigmoid, inline="always")
def _sigmoid(z):  # type: ignore[no-untyped-def]
    if z == types.float32:
        return lambda z: np.float32(1) / (np.float32(1) + _exp(-z))
    return lambda z: 1 / (1 + np.exp(-z))


@njit(inline="always")
def _exp(x: Any) -> Any:
    """Return exp in float32: a power of two times a polynomial; vectorisable.

    2ʳ = 1 + r·q(r) on |r| ≤ ½ to 9.1e-8, q fitted by reweighted least squares. What
    x·log₂e loses where x is large, a sigmoid doesn't feel.
    """
    x = min(max(x * np.float32(1.44269504), np.float32(-126)), np.float32(126))
    n = np.floor(x + np.float32(0.5))
    r = x - n
    q = np.float32(1.326472721e-3)
    q = q * r + np.float32(9.671512813e-3)
    q = q * r + np.float32(5.550733745e-2)
    q = q * r + np.float32(2.402224208e-1)
    q = q * r + np.float32(6.931469776e-1)
    p = np.float32(q * r + np.float32(1)).view(np.int32)
    return np.int32(p + (np.int32(n) << np.int32(23))).view(np.float32)


@overload(floats, inline="always")
def _floats(values, scratch):  # type: ignore[no-untyped-def]
    if values.dtype != types.uint16:
        return lambda values, scratch: values

    def widened(values, scratch):  # type: ignore[no-untyped-def]
        for j in range(len(values)):
            scratch[j] = np.int32(np.int32(values[j]) << np.int32(16)).view(np.float32)
        return scratch

    return widened


@overload(rounded, inline="always")
def _rounded(value, where):  # type: ignore[no-untyped-def]
    if where.dtype != types.uint16:
        return lambda value, where: value

    def narrowed(value, where):  # type: ignore[no-untyped-def]
        """Round to the nearest bfloat16, ties to even."""
        bits = np.float32(value).view(np.int32)
        last = (bits >> np.int32(16)) & np.int32(1)
        return np.uint16((bits + np.int32(0x7FFF) + last) >> np.int32(16))

    return narrowed


@overload(room_for, inline="always")
def _room_for(values, scratch):  # type: ignore[no-untyped-def]
    if values.dtype == types.uint16:
        return lambda values, scratch: scratch
    return lambda values, scratch: values


@overload(put, inline="always")
def _put(values, where):  # type: ignore[no-untyped-def]
    def copied(values, where):  # type: ignore[no-untyped-def]
        for j in range(len(values)):
            where[j] = rounded(values[j], where)

    return copied


@overload(keep, inline="always")
def _keep(values, where):  # type: ignore[no-untyped-def]
    if where.dtype == types.uint16:
        return lambda values, where: put(values, where)
    return lambda values, where: None
