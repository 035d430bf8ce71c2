"""What training makes small: one number for predicted and true displacement."""

from collections.abc import Callable, Mapping

import torch
from torch import Tensor


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
    "mean_euclidean": mean_euclidean,
    "mean_square": mean_square,
    "mean_absolute": mean_absolute,
    "root_mean_square_sample": root_mean_square_sample,
    "relative_sample": relative_sample,
}
"""Each takes predicted and true displacement, (batch, n_points, 3), mm."""
