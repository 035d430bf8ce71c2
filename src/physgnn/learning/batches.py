"""Samples of a store as batches, read as they're needed."""

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import DataLoader, Dataset, Sampler

from physgnn.dataset.store import Store
from physgnn.learning.interface import Model

IntArray = NDArray[np.int64]
Batch = tuple[Tensor, Tensor]


class Samples(Dataset[Batch]):
    """A model's inputs and the true displacement of each sample.

    Nothing is kept here: the store's bounded cache decides how much is in memory.
    """

    def __init__(self, store: Store, samples: IntArray, model: Model) -> None:
        self.store = store
        self.samples = samples
        self.model = model

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, index: int) -> Batch:
        path, level = (int(i) for i in self.samples[index])
        inputs = self.model.encode(self.store.load_case(path, level))
        return inputs, torch.tensor(self.store.displacement(path)[level])


class EpochOrder(Sampler[int]):
    """A shuffle that follows from seed and epoch alone, so that a resume repeats it."""

    def __init__(self, n_samples: int, seed: int) -> None:
        self.n_samples = n_samples
        self.seed = seed
        self.epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Choose the epoch; Lightning calls this."""
        self.epoch = epoch

    def __len__(self) -> int:
        return self.n_samples

    def __iter__(self) -> Iterator[int]:
        generator = np.random.default_rng([self.seed, self.epoch])
        return iter(generator.permutation(self.n_samples).tolist())


def training_batches(samples: Samples, batch_size: int, seed: int) -> DataLoader[Batch]:
    """Return shuffled batches, another order every epoch."""
    order = EpochOrder(len(samples), seed)
    return DataLoader(samples, batch_size=batch_size, sampler=order)


def validation_batches(samples: Samples, batch_size: int) -> DataLoader[Batch]:
    """Return batches in order."""
    return DataLoader(samples, batch_size=batch_size)
