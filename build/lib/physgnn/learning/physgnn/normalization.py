"""The six force columns brought to mean 0 and standard deviation 1."""

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.physgnn.features import force_features


class Normalizer(nn.Module):
    """Mean and standard deviation of each column, kept with the weights.

    They are over every point of every sample, unloaded points included, with n − 1 in
    the variance, as published.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, n_columns: int = 6) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(n_columns, dtype=torch.float64))
        self.register_buffer("std", torch.ones(n_columns, dtype=torch.float64))

    def set(self, mean: FloatArray, std: FloatArray) -> None:
        """Set both; a column that doesn't vary is left unscaled."""
        self.mean.copy_(torch.from_numpy(np.asarray(mean)))
        self.std.copy_(torch.from_numpy(np.where(std > 0, std, 1.0)))

    def fit(self, store: Store, samples: IntArray) -> None:
        """Set mean and standard deviation of the force columns over these samples.

        Unloaded points are counted, not visited: their columns are zero.
        """
        self.set(*force_statistics(store, samples))

    def standardise(self, columns: FloatArray) -> FloatArray:
        """Return standardised columns, (…, n_columns) float64."""
        scaled: FloatArray = (
            columns - self.mean.cpu().numpy()
        ) / self.std.cpu().numpy()
        return scaled


def force_statistics(store: Store, samples: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and (n − 1) standard deviation of the six force columns."""
    total, squares = np.zeros(6), np.zeros(6)
    for path, level in samples:
        columns = force_features(store.load_case(int(path), int(level)).forces)
        total += columns.sum(axis=0)
        squares += (columns**2).sum(axis=0)
    count = len(samples) * store.mesh.n_points
    mean = total / count
    return mean, np.sqrt(np.maximum(squares - count * mean**2, 0.0) / (count - 1))
