"""Attention over layers: which of a point's layer outputs matters, says an LSTM."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from physgnn.learning.cpu import LayerScores, compiled_for
from physgnn.learning.physgnn.pruning import filled


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
    compiled : LayerScores
        What scores layers on the processor.
    """

    def __init__(self, width: int, n_layers: int) -> None:
        super().__init__()
        hidden = width * n_layers // 2
        self.lstm = nn.LSTM(width, hidden, bidirectional=True)
        self.score = nn.Linear(2 * hidden, 1)
        self.compiled = LayerScores(self.lstm, self.score)

    def forward(
        self,
        layers: Sequence[Tensor],
        common: Sequence[Tensor] | None = None,
        rows: Tensor | None = None,
    ) -> Tensor:
        """Return the layers' weighted mean.

        Parameters
        ----------
        layers : sequence of (batch, n_k, width) tensors
            Each layer's output on the first points, ever more of them.
        common : sequence of (n − n_k, width) tensors, optional
            Each layer's output on the other points, the same for all samples.
        rows : (n,) tensor, optional
            Points whose mean is wanted, ascending; by default all.

        Returns
        -------
        (batch, n, width) tensor
        """
        if rows is not None:
            if not len(rows):
                return layers[0][:, :0]
            layers, common = _on_rows(layers, common, rows)
        whole = layers if common is None else list(map(filled, layers, common))
        if compiled_for(whole[0]):
            scores = self.compiled(layers, common)
        else:
            scores = self.scores(whole)
        weights = torch.softmax(scores, dim=0)[..., None]
        mean = weights[0] * whole[0]
        for weight, layer in zip(weights[1:], whole[1:], strict=True):
            mean = torch.addcmul(mean, weight, layer)
        return mean

    def scores(self, layers: Sequence[Tensor]) -> Tensor:
        """Score every layer on every point, (n_layers, batch, n), by torch's LSTM."""
        sequences = torch.stack([layer.flatten(0, 1) for layer in layers])
        scores: Tensor = self.score(self.lstm(sequences)[0])
        return scores.view(len(layers), *layers[0].shape[:2])


class LastLayer(nn.Module):
    """The last layer alone, in the place of attention over all of them."""

    def forward(
        self,
        layers: Sequence[Tensor],
        common: Sequence[Tensor] | None = None,
        rows: Tensor | None = None,
    ) -> Tensor:
        """Return the last layer's output; arguments as of `JumpingKnowledge`."""
        if rows is not None:
            layers, common = _on_rows(layers, common, rows)
        return layers[-1] if common is None else filled(layers[-1], common[-1])


def _on_rows(
    layers: Sequence[Tensor], common: Sequence[Tensor] | None, rows: Tensor
) -> tuple[Sequence[Tensor], Sequence[Tensor] | None]:
    """Take some rows of layers, of which each has its own first and all the same."""
    own = [rows[rows < layer.shape[1]] for layer in layers]
    if common is not None:
        common = [
            other.index_select(0, rows[len(first) :] - layer.shape[1])
            for layer, other, first in zip(layers, common, own, strict=True)
        ]
    picked = [
        layer.index_select(1, first) for layer, first in zip(layers, own, strict=True)
    ]
    return picked, common
