"""Samples of a store as batches, made once and read back in later epochs."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset, Sampler

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.learning.network import Network
from physgnn.learning.training.samples.sample_cache import SampleCache

Batch = tuple[Tensor, Tensor]


class Share(NamedTuple):
    """Which of so many processes that train together this one is."""

    rank: int = 0
    of: int = 1


ALONE = Share()


class Samples(Dataset[Batch]):
    """A model's inputs and the true displacement of each sample.

    Parameters
    ----------
    store : Store
        Read once a sample if there's a cache.
    samples : (n, 2) array
        Path and level.
    model : Network
        Encodes the load; already fitted.
    cache : SampleCache, optional
        Without, every sample is made whenever it's asked for.
    """

    def __init__(
        self,
        store: Store,
        samples: IntArray,
        model: Network,
        cache: SampleCache | None = None,
    ) -> None:
        self.store = store
        self.samples = samples
        self.model = model
        self.cache = cache

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, index: int) -> Batch:
        path, level = (int(i) for i in self.samples[index])
        columns = self.cache.get((path, level)) if self.cache else None
        if columns is None:
            columns = self._made(path, level)
            if self.cache:
                self.cache.put((path, level), columns)
        return columns[:, :-3], columns[:, -3:]

    def make_all(self) -> None:
        """Make the samples in their order, as far as the cache has room for them.

        To rounding, an encoding may depend on those made before it. Made in the order
        in which batches ask for them, they would differ after a resume.
        """
        for index, (path, level) in enumerate(self.samples.tolist()):
            self[index]
            if self.cache is None or (path, level) not in self.cache:
                return

    def _made(self, path: int, level: int) -> Tensor:
        inputs = self.model.encode(self.model.sample_case(self.store, path, level))
        true = torch.tensor(self.store.displacement(path)[level])
        return torch.cat([inputs, true], dim=1)


class EpochOrder(Sampler[list[int]]):
    """Batches of a shuffle that follows from seed and epoch alone: a resume repeats it.

    Processes that train together share every batch out; one that is too small for each
    to get a sample is left out.
    """

    def __init__(
        self, n_samples: int, batch_size: int, seed: int, share: Share = ALONE
    ) -> None:
        self.n_samples = n_samples
        self.batch_size = batch_size
        self.seed = seed
        self.share = share
        self.epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Choose the epoch; Lightning calls this."""
        self.epoch = epoch

    def __len__(self) -> int:
        whole, rest = divmod(self.n_samples, self.batch_size)
        return whole + (rest >= self.share.of)

    def __iter__(self) -> Iterator[list[int]]:
        generator = np.random.default_rng([self.seed, self.epoch])
        order = generator.permutation(self.n_samples).tolist()
        for i in range(len(self)):
            batch = order[i * self.batch_size : (i + 1) * self.batch_size]
            yield batch[self.share.rank :: self.share.of]
