"""A U-Net in three dimensions (Ronneberger et al. 2015; Çiçek et al. 2016)."""

from itertools import pairwise

import torch
from torch import Tensor, nn

LEAK = 0.1  # slope of the activation below zero
FIRST_SIZE = 0.01  # of the last layer's weights before training, of what is usual


def convolutions(n_inputs: int, n_outputs: int) -> nn.Sequential:
    """Return two convolutions over 3³ nodes, each with its activation."""
    return nn.Sequential(
        nn.Conv3d(n_inputs, n_outputs, 3, padding=1),
        nn.LeakyReLU(LEAK),
        nn.Conv3d(n_outputs, n_outputs, 3, padding=1),
        nn.LeakyReLU(LEAK),
    )


class UNet(nn.Module):
    """Fields to ever coarser grids, and back, with what each finer grid knew.

    Every level down halves the nodes along each axis and doubles the columns.

    Parameters
    ----------
    n_inputs, n_outputs : int
        Columns of fields.
    width : int
        Columns on the finest grid.
    levels : int
        How often the grid is halved; 2 to this power divides its nodes.
    """

    def __init__(
        self, n_inputs: int, n_outputs: int, *, width: int, levels: int
    ) -> None:
        super().__init__()
        widths = [width * 2**k for k in range(levels + 1)]
        pairs = list(pairwise(widths))
        self.first = convolutions(n_inputs, width)
        self.halve = nn.MaxPool3d(2)
        self.down = nn.ModuleList(convolutions(a, b) for a, b in pairs)
        self.finer = nn.ModuleList(
            nn.ConvTranspose3d(b, a, 2, stride=2) for a, b in reversed(pairs)
        )
        self.up = nn.ModuleList(convolutions(2 * a, a) for a, _ in reversed(pairs))
        self.last = nn.Conv3d(width, n_outputs, 1)
        # Training begins near zero: from anywhere else it first has to unlearn that.
        with torch.no_grad():
            for weights in self.last.parameters():
                weights.mul_(FIRST_SIZE)

    def forward(self, fields: Tensor) -> Tensor:
        """Return (batch, n_outputs, n, n, n) of (batch, n_inputs, n, n, n)."""
        states = [self.first(fields)]
        for convolve in self.down:
            states.append(convolve(self.halve(states[-1])))
        state = states.pop()
        for finer, convolve in zip(self.finer, self.up, strict=True):
            state = convolve(torch.cat([states.pop(), finer(state)], dim=1))
        outputs: Tensor = self.last(state)
        return outputs
