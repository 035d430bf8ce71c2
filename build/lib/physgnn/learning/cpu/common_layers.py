"""What an LSTM's sequences have in common with those of other samples, read once.

Six hops carry a load so far, and three layers half as far: away from the loads, the
first of the layers that an LSTM reads are the same for all samples of a batch. If it
reads them first, the state after them is computed once; if last, the matrix's products
with them are.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from torch import Tensor, cat
from torch.nn.functional import linear, pad

from physgnn.learning.cpu.lstm_inputs import Given, Weights
from physgnn.learning.cpu.lstm_scores import PLAIN, Way, lstm


class Shared(NamedTuple):
    """What is the same for all samples; see :class:`Given`.

    Attributes
    ----------
    products, start
        As there.
    scores : (steps, n − n_0) tensor or None
        Of the steps before the start.
    """

    products: tuple[Tensor | None, ...]
    start: tuple[Tensor, Tensor] | None = None
    scores: Tensor | None = None


def read_shared(inputs: Sequence[Tensor], weights: Weights, way: Way) -> Shared:
    """Read what samples have in common.

    Parameters
    ----------
    inputs : sequence of (n − n_k, width) tensors
        By step, the inputs of the last of the n points; of ever more of them, or ever
        fewer. At some step there are none.
    weights, way
        As in :func:`physgnn.learning.cpu.lstm_scores.lstm`.
    """
    if len(inputs[0]):
        return _before(inputs, weights, way)
    matrix = weights.matrix[:, : weights.width]
    return Shared(
        tuple(linear(x, matrix, weights.bias) if len(x) else None for x in inputs)
    )


def _before(inputs: Sequence[Tensor], weights: Weights, way: Way) -> Shared:
    """Read the steps that come first, on points that have as many of them."""
    n, found = len(inputs[0]), []
    cuts = [n - len(x) for x in inputs]
    for n_steps, (start, stop) in enumerate(pairwise(cuts), start=1):
        if start == stop:
            continue
        own = tuple(
            x[None, start - cut : stop - cut]
            for x, cut in zip(inputs[:n_steps], cuts, strict=False)
        )
        scores, *state = lstm(Given(own, (None,) * n_steps), weights, way, end=True)
        scores = pad(scores[:, 0], (0, 0, 0, len(inputs) - n_steps))
        found.append([*(x[0] for x in state), scores.t()])
    hidden, cell, scores = (cat(parts) for parts in zip(*found, strict=True))
    return Shared((None,) * len(inputs), (hidden, cell), scores.t())


def lstm_scores(
    own: Sequence[Tensor],
    weights: Weights,
    common: Shared | None = None,
    way: Way = PLAIN,
) -> Tensor:
    """Read a sequence from rest and score the hidden state after every step.

    Parameters
    ----------
    own : sequence of (batch, n_k, width) tensors
        By step, the inputs that are each sample's own: those of the first points.
    weights : Weights
        The LSTM.
    common : Shared, optional
        What the samples have in common on the other points.
    way : Way
        How to compute.

    Returns
    -------
    (steps, batch, n) tensor
    """
    common = common or Shared((None,) * len(own))
    given = Given(tuple(own), common.products, common.start)
    scores, *_ = lstm(given, weights, way)
    if common.scores is None:
        return scores
    n_before = scores.shape[2] - common.scores.shape[1]
    return scores + pad(common.scores, (n_before, 0))[:, None]
