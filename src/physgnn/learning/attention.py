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
        attention = torch.softmax(self._scores(rows) + self.score.bias, dim=1)
        mean = rows[0] * attention[:, :1]
        for k in range(1, len(rows)):
            mean = torch.addcmul(mean, rows[k], attention[:, k : k + 1])
        return mean.view(layers[0].shape)

    def _scores(self, rows: Sequence[Tensor]) -> Tensor:
        """Return a score of every row and layer, without bias."""
        if rows[0].device.type != "cpu":
            hidden, _ = self.lstm(torch.stack(list(rows)))
            return nn.functional.linear(hidden, self.score.weight)[..., 0].t()
        ahead, back = self._weights()
        keep = self.keep_states
        return lstm_scores(rows, ahead, keep=keep) + lstm_scores(
            rows[::-1], back, keep=keep
        ).flip(1)

    def _weights(self) -> tuple[Weights, Weights]:
        """Return both directions' weights, gates in the order they are computed in."""
        given = dict(self.lstm.named_parameters())
        precision = None if torch.is_grad_enabled() else self.precision
        directions = []
        for suffix, score in zip(
            ("l0", "l0_reverse"), self.score.weight[0].chunk(2), strict=True
        ):
            from_both = (given[f"weight_{x}h_{suffix}"] for x in "ih")
            bias = given[f"bias_ih_{suffix}"] + given[f"bias_hh_{suffix}"]
            matrix = _reordered(torch.cat(list(from_both), dim=1))
            if precision == torch.bfloat16:
                matrix = matrix.to(precision)
            directions.append(Weights(matrix, _reordered(bias), score))
        return directions[0], directions[1]


def _reordered(weight: Tensor) -> Tensor:
    i, f, g, o = weight.chunk(4)
    return torch.cat([f, i, 2 * g, o])
