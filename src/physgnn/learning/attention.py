"""Attention over layers: which of a point's layer outputs matters, says an LSTM."""

from collections.abc import Sequence
from operator import is_

import torch
from torch import Tensor, nn

from physgnn.learning.layer_mean import layer_mean
from physgnn.learning.lstm import Way
from physgnn.learning.lstm_data import Weights
from physgnn.learning.lstm_shared import Shared, lstm_scores, read_shared
from physgnn.learning.pruning import filled

Direction = tuple[Weights, Shared | None]


class JumpingKnowledge(nn.Module):
    """The layers' mean, weighted by a bidirectional LSTM that reads them in order.

    Jumping knowledge with LSTM attention (Xu et al. 2018), hidden size
    width · layers / 2. The parameters are those of `torch.nn.LSTM`.

    Parameters
    ----------
    width : int
        Columns of each layer's output.
    n_layers : int
        Number of layers.

    Attributes
    ----------
    keep_states : bool
        Keep what the LSTM's way back needs, or compute it twice: a tenth more time and
        a quarter of the memory in training.
    precision : torch.dtype or None
        Of the LSTM's products, bfloat16 or else the weights'.
    """

    def __init__(self, width: int, n_layers: int) -> None:
        super().__init__()
        hidden = width * n_layers // 2
        self.lstm = nn.LSTM(width, hidden, bidirectional=True)
        self.score = nn.Linear(2 * hidden, 1)
        self.keep_states = True
        self.precision: torch.dtype | None = None
        self._kept: tuple[Sequence[Tensor], tuple[Direction, Direction]] | None = None

    def forward(
        self, layers: Sequence[Tensor], common: Sequence[Tensor] | None = None
    ) -> Tensor:
        """Return the layers' weighted mean.

        Parameters
        ----------
        layers : sequence of (batch, n_k, width) tensors
            Each layer's output on the first points, ever more of them.
        common : sequence of (n − n_k, width) tensors, optional
            Each layer's output on the other points, the same for all samples.

        Returns
        -------
        (batch, n, width) tensor
        """
        scores = self._scores(layers, common) + self.score.bias
        return layer_mean(torch.softmax(scores, dim=0), _whole(layers, common))

    def _scores(
        self, layers: Sequence[Tensor], common: Sequence[Tensor] | None
    ) -> Tensor:
        """Return a score of every layer on every point, without bias."""
        if layers[0].device.type != "cpu":
            rows = torch.stack([x.flatten(0, 1) for x in _whole(layers, common)])
            scores = nn.functional.linear(self.lstm(rows)[0], self.score.weight)
            return scores.view(len(layers), *layers[-1].shape[:2])
        way = Way(self.precision, self.keep_states)
        ahead, back = self._directions(common, way)
        return lstm_scores(layers, *ahead, way) + lstm_scores(
            layers[::-1], *back, way
        ).flip(0)

    def _directions(
        self, common: Sequence[Tensor] | None, way: Way
    ) -> tuple[Direction, Direction]:
        """Return each direction's weights, and what it makes of what is common.

        Without a way back they're kept as long as the same tensors are given: those
        rest on the same weights.
        """
        kept, training = self._kept, torch.is_grad_enabled()
        if kept and common and not training and all(map(is_, kept[0], common)):
            return kept[1]
        ahead, back = self._weights()
        if common is None:
            return (ahead, None), (back, None)
        made = (
            (ahead, read_shared(common, ahead, way)),
            (back, read_shared(common[::-1], back, way)),
        )
        self._kept = None if training else (common, made)
        return made

    def _weights(self) -> tuple[Weights, Weights]:
        """Return both directions' weights, gates in the order they are computed in."""
        given = dict(self.lstm.named_parameters())
        directions = []
        for suffix, score in zip(
            ("l0", "l0_reverse"), self.score.weight[0].chunk(2), strict=True
        ):
            from_both = (given[f"weight_{x}h_{suffix}"] for x in "ih")
            bias = given[f"bias_ih_{suffix}"] + given[f"bias_hh_{suffix}"]
            matrix = _reordered(torch.cat([*from_both], dim=1))
            directions.append(Weights(matrix, _reordered(bias), score))
        return directions[0], directions[1]


def _whole(
    layers: Sequence[Tensor], common: Sequence[Tensor] | None
) -> Sequence[Tensor]:
    """Return the layers' outputs on all points."""
    return layers if common is None else list(map(filled, layers, common))


def _reordered(weight: Tensor) -> Tensor:
    i, f, g, o = weight.chunk(4)
    return torch.cat([f, i, 2 * g, o])
