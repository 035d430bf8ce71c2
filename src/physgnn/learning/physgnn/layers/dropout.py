"""Dropout whose mask of a sample doesn't depend on the samples beside it."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn


class SampleDropout(nn.Module):
    """Dropout, seeded a sample if wanted.

    Then a batch may be cut into parts, or shared out over processes, and a resumed run
    repeats an uninterrupted one.

    Parameters
    ----------
    probability : float
        Of a value to become 0; the others are divided by 1 − probability.
    """

    def __init__(self, probability: float) -> None:
        super().__init__()
        self.probability = probability
        self.seeds: Sequence[int] | None = None

    def forward(self, x: Tensor) -> Tensor:
        """Return x, its rows sample after sample, with values dropped if training."""
        if not self.training:
            return x
        if self.seeds is None:
            return nn.functional.dropout(x, self.probability)
        samples = zip(x.chunk(len(self.seeds)), self.seeds, strict=True)
        return x * torch.cat([self._mask(sample, seed) for sample, seed in samples])

    def _mask(self, sample: Tensor, seed: int) -> Tensor:
        generator = torch.Generator(sample.device).manual_seed(seed)
        keep = 1.0 - self.probability
        return torch.empty_like(sample).bernoulli_(keep, generator=generator) / keep


def seed_dropout(network: nn.Module, seeds: Sequence[int] | None) -> None:
    """Give the samples of the next batch their seeds; None for a common stream."""
    for module in network.modules():
        if isinstance(module, SampleDropout):
            module.seeds = seeds
