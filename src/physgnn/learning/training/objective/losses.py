"""What training makes small: one number for predicted and true displacement."""

from collections.abc import Callable, Mapping

import torch
from torch import Tensor

from physgnn import choices


def mean_euclidean(predicted: Tensor, true: Tensor) -> Tensor:
    """Return the mean length of the error, mm: the published loss."""
    length: Tensor = torch.linalg.vector_norm(predicted - true, dim=-1)
    return length.mean()


def mean_square(predicted: Tensor, true: Tensor) -> Tensor:
    """Return the mean squared length of the error, mm²."""
    return (predicted - true).square().sum(dim=-1).mean()


def mean_absolute(predicted: Tensor, true: Tensor) -> Tensor:
    """Return the mean absolute error of a component, mm."""
    return (predicted - true).abs().mean()


def root_mean_square_sample(predicted: Tensor, true: Tensor) -> Tensor:
    """Return the mean over samples of √(mean squared length of the error), mm."""
    return (predicted - true).square().sum(dim=-1).mean(dim=-1).sqrt().mean()


def relative_sample(predicted: Tensor, true: Tensor) -> Tensor:
    """Return the mean over samples of the error's size over the displacement's.

    Small loads then count as much as large ones.
    """
    error, size = (x.square().sum(dim=(-1, -2)) for x in (predicted - true, true))
    return (error / size.clamp_min(torch.finfo(size.dtype).tiny)).sqrt().mean()


LossFunction = Callable[[Tensor, Tensor], Tensor]

LOSSES: Mapping[str, LossFunction] = {
    choices.LossName.MEAN_EUCLIDEAN: mean_euclidean,
    choices.LossName.MEAN_SQUARE: mean_square,
    choices.LossName.MEAN_ABSOLUTE: mean_absolute,
    choices.LossName.ROOT_MEAN_SQUARE_SAMPLE: root_mean_square_sample,
    choices.LossName.RELATIVE_SAMPLE: relative_sample,
}
"""Each takes predicted and true displacement, (batch, n_points, 3), mm."""
