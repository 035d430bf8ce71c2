"""Attention over layers: which of a point's layer outputs matters, says an LSTM."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from physgnn.learning.lstm import Weights, lstm_scores


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
    precision : torch.dtype
        Of the LSTM when predicting; training and the layers' mean are float32.
    """

    def __init__(self, width: int, n_layers: int) -> None:
        super().__init__()
        hidden = width * n_layers // 2
        self.lstm = nn.LSTM(width, hidden, bidirectional=True)
        self.score = nn.Linear(2 * hidden, 1)
        self.keep_states = True
        self.precision = torch.float32

    def forward(self, layers: Sequence[Tensor]) -> Tensor:
        """Return the layers' weighted mean, each (…, width)."""
        rows = [layer.flatten(0, -2) for layer in layers]
        ahead, back = self._weights()
        scores = self._scores(rows, ahead) + self._scores(rows[::-1], back).flip(1)
        attention = torch.softmax(scores + self.score.bias, dim=1)
        mean = rows[0] * attention[:, :1]
        for k in range(1, len(rows)):
            mean = torch.addcmul(mean, rows[k], attention[:, k : k + 1])
        return mean.view(layers[0].shape)

    def _scores(self, rows: Sequence[Tensor], weights: Weights) -> Tensor:
        given = rows[0].dtype
        if self.precision != torch.float32 and not torch.is_grad_enabled():
            rows = [row.to(self.precision) for row in rows]
            weights = Weights(*(weight.to(self.precision) for weight in weights))
        return lstm_scores(rows, weights, keep=self.keep_states).to(given)

    def _weights(self) -> tuple[Weights, Weights]:
        """Return both directions' weights, gates in the order they are computed in."""
        given = dict(self.lstm.named_parameters())
        ahead, back = self.score.weight[0].chunk(2)
        directions = []
        for suffix, score in (("l0", ahead), ("l0_reverse", back)):
            bias = given[f"bias_ih_{suffix}"] + given[f"bias_hh_{suffix}"]
            from_input = given[f"weight_ih_{suffix}"]
            from_hidden = given[f"weight_hh_{suffix}"]
            directions.append(
                Weights(
                    _reordered(bias),
                    _reordered(from_input),
                    _reordered(from_hidden),
                    score,
                )
            )
        return directions[0], directions[1]


def _reordered(weight: Tensor) -> Tensor:
    i, f, g, o = weight.chunk(4)
    return torch.cat([f, i, 2 * g, o])
