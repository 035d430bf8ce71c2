"""Scores of layers: a bidirectional LSTM reads each point's layers, first to last."""

from collections.abc import Sequence
from operator import is_

import torch
from torch import Tensor, nn

from physgnn.learning.cpu.common_layers import Shared, lstm_scores, read_shared
from physgnn.learning.cpu.lstm_inputs import Weights
from physgnn.learning.cpu.lstm_scores import Way

Direction = tuple[Weights, Shared | None]


def compiled_for(x: Tensor) -> bool:
    """Tell whether there are compiled kernels for the device a tensor is on."""
    return x.device.type == "cpu"


class LayerScores:
    """The same scores as those of `torch.nn.LSTM` and a linear layer, compiled.

    Parameters
    ----------
    lstm : LSTM
        Bidirectional, of one layer; its weights are shared.
    score : Linear
        From the hidden states of both directions to a score; shared too.

    Attributes
    ----------
    keep_states : bool
        Keep what the LSTM's backward pass needs, or compute it twice: a tenth more time
        and a quarter of the memory in training.
    precision : torch.dtype or None
        Of the LSTM's products, bfloat16 or else the weights'.
    """

    def __init__(self, lstm: nn.LSTM, score: nn.Linear) -> None:
        self.lstm = lstm
        self.score = score
        self.keep_states = True
        self.precision: torch.dtype | None = None
        self._kept: tuple[Sequence[Tensor], tuple[Direction, Direction]] | None = None

    def __call__(
        self, layers: Sequence[Tensor], common: Sequence[Tensor] | None = None
    ) -> Tensor:
        """Score every layer on every point.

        Parameters
        ----------
        layers : sequence of (batch, n_k, width) tensors
            Each layer's output on the first points, ever more of them.
        common : sequence of (n − n_k, width) tensors, optional
            Each layer's output on the other points, the same for all samples.

        Returns
        -------
        (n_layers, batch, n) tensor
        """
        way = Way(self.precision, self.keep_states)
        ahead, back = self._directions(common, way)
        scores = lstm_scores(layers, *ahead, way)
        scores = scores + lstm_scores(layers[::-1], *back, way).flip(0)
        return scores + self.score.bias

    def _directions(
        self, common: Sequence[Tensor] | None, way: Way
    ) -> tuple[Direction, Direction]:
        """Return each direction's weights, and what it makes of what is common.

        Without a backward pass they're kept as long as the same tensors are given:
        those rest on the same weights.
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


def _reordered(weight: Tensor) -> Tensor:
    i, f, g, o = weight.chunk(4)
    return torch.cat([f, i, 2 * g, o])
