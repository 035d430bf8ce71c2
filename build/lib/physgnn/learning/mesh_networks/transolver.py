"""Transolver: attention among learnt slices of a mesh (Wu et al. 2024, section 3)."""

import torch
from torch import Tensor, nn
from torch.nn import functional

EMPTY = 1e-5  # keeps the mean over a slice that no point belongs to finite
FIRST_TEMPERATURE = 0.5


class PhysicsAttention(nn.Module):
    """Points into slices, attention among the slices, slices back to the points.

    Every point belongs to every slice by a weight (eq. 1); a slice's token is the mean
    of its points (eq. 2); tokens attend to each other, and every point receives the
    tokens by the same weights (eq. 3).

    Parameters
    ----------
    width, heads, slices : int
        Of a point's state; of the attention; learnt groups of points a head.
    """

    def __init__(self, width: int, heads: int, slices: int) -> None:
        super().__init__()
        self.heads, per_head = heads, width // heads
        self.temperature = nn.Parameter(torch.full((heads, 1, 1), FIRST_TEMPERATURE))
        self.to_weights = nn.Linear(width, width)
        self.to_values = nn.Linear(width, width)
        self.slice = nn.Linear(per_head, slices)
        nn.init.orthogonal_(self.slice.weight)
        self.query, self.key, self.value = (
            nn.Linear(per_head, per_head, bias=False) for _ in range(3)
        )
        self.out = nn.Linear(width, width)

    def forward(self, states: Tensor) -> Tensor:
        """Return (batch, n_points, width) of the same."""
        logits = self.slice(self._by_head(self.to_weights(states)))
        weights = (logits / self.temperature).softmax(dim=-1)
        tokens = weights.transpose(-1, -2) @ self._by_head(self.to_values(states))
        tokens = tokens / (weights.sum(dim=-2).unsqueeze(-1) + EMPTY)
        tokens = functional.scaled_dot_product_attention(
            self.query(tokens), self.key(tokens), self.value(tokens)
        )
        points = (weights @ tokens).transpose(1, 2).flatten(start_dim=2)
        out: Tensor = self.out(points)
        return out

    def _by_head(self, states: Tensor) -> Tensor:
        """Return (batch, heads, n_points, width / heads)."""
        batch, n_points, width = states.shape
        by_head = states.view(batch, n_points, self.heads, width // self.heads)
        return by_head.transpose(1, 2)


class AttentionBlock(nn.Module):
    """Attention, then a perceptron, each added to what it was given.

    Parameters
    ----------
    width, heads, slices : int
        See :class:`PhysicsAttention`.
    """

    def __init__(self, width: int, heads: int, slices: int) -> None:
        super().__init__()
        self.norm_attention, self.norm_point = nn.LayerNorm(width), nn.LayerNorm(width)
        self.attention = PhysicsAttention(width, heads, slices)
        self.point = nn.Sequential(
            nn.Linear(width, width), nn.GELU(), nn.Linear(width, width)
        )

    def forward(self, states: Tensor) -> Tensor:
        """Return (batch, n_points, width) of the same."""
        states = states + self.attention(self.norm_attention(states))
        after: Tensor = states + self.point(self.norm_point(states))
        return after


class Transolver(nn.Module):
    """A perceptron a point, blocks of attention, a linear map to the outputs.

    Parameters
    ----------
    n_inputs, n_outputs : int
        Columns of points.
    width, layers, heads, slices : int
        Of the states; blocks; see :class:`PhysicsAttention`.
    """

    def __init__(
        self, n_inputs: int, n_outputs: int, *, width: int, layers: int, heads: int,
        slices: int,
    ) -> None:  # fmt: skip
        super().__init__()
        self.encoder = nn.Sequential(
            nn.Linear(n_inputs, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )
        self.blocks = nn.ModuleList(
            AttentionBlock(width, heads, slices) for _ in range(layers)
        )
        self.decoder = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, n_outputs))

    def forward(self, inputs: Tensor) -> Tensor:
        """Return (batch, n_points, n_outputs) of (batch, n_points, n_inputs)."""
        states = self.encoder(inputs)
        for block in self.blocks:
            states = block(states)
        outputs: Tensor = self.decoder(states)
        return outputs
