"""Attention over layers: which of a point's layer outputs matters, says an LSTM."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from physgnn.learning.rowwise import rowwise


class JumpingKnowledge(nn.Module):
    """The layers' mean, weighted by a bidirectional LSTM that reads them in order.

    Jumping knowledge with LSTM attention (Xu et al. 2018), hidden size
    width · layers / 2. The parameters are those of `torch.nn.LSTM`; the arithmetic is
    written out because a sequence of three, for thousands of points, is a handful of
    matrix products.

    Parameters
    ----------
    width : int
        Columns of each layer's output.
    n_layers : int
        Number of layers.
    """

    def __init__(self, width: int, n_layers: int) -> None:
        super().__init__()
        hidden = width * n_layers // 2
        self.lstm = nn.LSTM(width, hidden, bidirectional=True)
        self.score = nn.Linear(2 * hidden, 1)

    def forward(self, layers: Sequence[Tensor]) -> Tensor:
        """Return the layers' weighted mean, each (…, width)."""
        ahead, back = self.score.weight[0].chunk(2)
        weights = (
            self.score.bias,
            *(*self._direction(""), ahead),
            *(*self._direction("_reverse"), back),
        )
        rows = [layer.flatten(0, -2) for layer in layers]
        return rowwise(_weighted_mean, rows, weights).view(layers[0].shape)

    def _direction(self, suffix: str) -> tuple[Tensor, Tensor, Tensor]:
        """Return one direction's bias and weights as `_scores` takes them.

        Gates are reordered to f, i, g, o and g's doubled, tanh(g) being 2σ(2g) − 1.
        """
        parameters = dict(self.lstm.named_parameters())
        bias = parameters[f"bias_ih_l0{suffix}"] + parameters[f"bias_hh_l0{suffix}"]
        packed = []
        for weight in (
            bias,
            parameters[f"weight_ih_l0{suffix}"],
            parameters[f"weight_hh_l0{suffix}"],
        ):
            i, f, g, o = weight.chunk(4)
            packed.append(torch.cat([f, i, 2 * g, o]))
        return packed[0], packed[1], packed[2]


def _weighted_mean(layers: Sequence[Tensor], weights: Sequence[Tensor]) -> Tensor:
    bias, *directions = weights
    ahead = _scores(layers, directions[:4])
    back = _scores(layers[::-1], directions[4:])[::-1]
    scores = torch.stack(ahead, dim=1) + torch.stack(back, dim=1) + bias
    attention = torch.softmax(scores, dim=1)
    mean = layers[0] * attention[:, :1]
    for k in range(1, len(layers)):
        mean = torch.addcmul(mean, layers[k], attention[:, k : k + 1])
    return mean


def _scores(sequence: Sequence[Tensor], weights: Sequence[Tensor]) -> list[Tensor]:
    """Read a sequence with an LSTM from rest; return each hidden state's score."""
    bias, from_input, from_hidden, score = weights
    size = len(score)
    # At rest there is nothing to forget and no hidden state to look back to.
    gates = torch.addmm(bias[size:], sequence[0], from_input[size:].t()).sigmoid_()
    i, g, o = gates.chunk(3, dim=1)
    cell = _times_tanh(i, g)
    scores = []
    for x in sequence[1:]:
        hidden = _times_tanh(o, torch.sigmoid(2 * cell))
        scores.append(hidden @ score)
        gates = torch.addmm(bias, x, from_input.t())
        gates = gates.addmm_(hidden, from_hidden.t()).sigmoid_()
        f, i, g, o = gates.chunk(4, dim=1)
        cell = torch.addcmul(_times_tanh(i, g), f, cell)
    return [*scores, _times_tanh(o, torch.sigmoid(2 * cell)) @ score]


def _times_tanh(factor: Tensor, sigmoid_of_twice: Tensor) -> Tensor:
    """Return factor · tanh(x), given σ(2x); one exponential instead of a slow tanh."""
    return torch.addcmul(-factor, factor, sigmoid_of_twice, value=2)
