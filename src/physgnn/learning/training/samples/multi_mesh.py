"""Several bodies to learn from at once: each has its dataset, they share the weights.

Samples of different bodies have different sizes, so every batch is of one body.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader, Dataset, Sampler

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.freed_memory import give_back
from physgnn.learning.models import build_model
from physgnn.learning.network import Network
from physgnn.learning.surrogate import Surrogate
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.samples.batches import ALONE, EpochOrder, Samples, Share
from physgnn.learning.training.samples.sample_cache import SampleCache

Stores = Store | Sequence[Store]
Splits = Split | Sequence[Split]
MeshBatch = tuple[Tensor, Tensor, Tensor]


class TrainingMesh(NamedTuple):
    """One body's dataset, and what of it is used how."""

    store: Store
    split: Split


def training_meshes(stores: Stores, splits: Splits) -> list[TrainingMesh]:
    """Return one mesh a store; InputError unless there is a split for each."""
    stores = [stores] if isinstance(stores, Store) else list(stores)
    splits = [splits] if isinstance(splits, Split) else list(splits)
    if not stores or len(stores) != len(splits):
        raise InputError(
            f"training needs one split a store, and one store or more (got "
            f"{len(stores)} stores, {len(splits)} splits)"
        )
    return [TrainingMesh(*pair) for pair in zip(stores, splits, strict=True)]


def build_models(
    meshes: Sequence[TrainingMesh],
    config: TrainingConfig,
    start: Surrogate | None = None,
) -> list[Network]:
    """Return one network a mesh; all have the weights of the first, or of `start`.

    Raises
    ------
    InputError
        If weights are to be shared and what the model learns belongs to one body.
    """
    built = [
        build_model(config.model, mesh.store.body, **config.options) for mesh in meshes
    ]
    first, *others = models = [model for model in built if isinstance(model, Network)]
    if start is not None:
        first.begin_with(start)
    for other in others:
        other.share_weights(first)
    return models


def fitted_samples(
    meshes: Sequence[TrainingMesh],
    models: Sequence[Network],
    caches: Sequence[SampleCache],
    seed: int = 0,
) -> tuple[list[Samples], list[Samples]]:
    """Fit each model's statistics; return training and validation samples by mesh.

    The samples are encoded here, in the same order whether a training is resumed or
    not. Of several bodies this is done one body after the other, so that what encoding
    caches in memory is that of one body at a time.
    """
    training, validation = [], []
    for (store, split), model, cache in zip(meshes, models, caches, strict=True):
        used = split.train if len(split.train) else split.validation
        model.fit(store, used, seed)
        training.append(Samples(store, split.train, model, cache))
        validation.append(Samples(store, split.validation, model, cache))
        for samples in (training[-1], validation[-1]):
            samples.make_all()
        if len(meshes) > 1:
            model.release()
            give_back()
    return training, validation


def training_batches(
    parts: Sequence[Samples], batch_size: int, seed: int, share: Share
) -> DataLoader[MeshBatch]:
    """Return shuffled batches, another order every epoch."""
    order = MixedOrder([len(part) for part in parts], batch_size, seed, share)
    return ResumableLoader(Together(parts), order)


def validation_batches(
    parts: Sequence[Samples], batch_size: int, share: Share
) -> DataLoader[MeshBatch]:
    """Return this process's share of the samples in order."""
    order = in_order([len(part) for part in parts], batch_size, share)
    own = torch.Generator()  # as above: validating draws nothing from the network's
    return DataLoader(Together(parts), batch_sampler=order, generator=own)


class Together(Dataset[MeshBatch]):
    """Samples of all meshes, one after the other, each with its mesh's number."""

    def __init__(self, parts: Sequence[Samples]) -> None:
        self.parts = parts
        self.starts = _starts([len(part) for part in parts])

    def __len__(self) -> int:
        return sum(len(part) for part in self.parts)

    def __getitem__(self, index: int) -> tuple[Tensor, Tensor, int]:  # type: ignore[override]
        mesh = int(np.searchsorted(self.starts, index, side="right")) - 1
        inputs, true = self.parts[mesh][index - int(self.starts[mesh])]
        return inputs, true, mesh


class MixedOrder(Sampler[list[int]]):
    """Each mesh's batches as `EpochOrder` has them, the meshes shuffled.

    Attributes
    ----------
    begun : int
        Batches of this epoch that were given out. Set, the next epoch begins after so
        many.
    """

    def __init__(
        self, sizes: Sequence[int], batch_size: int, seed: int, share: Share = ALONE
    ) -> None:
        self.seed, self.epoch, self.begun = seed, 0, 0
        self.starts = _starts(sizes)
        self.orders = [EpochOrder(size, batch_size, seed, share) for size in sizes]

    def set_epoch(self, epoch: int) -> None:
        """Choose the epoch; Lightning calls this."""
        self.epoch = epoch
        for order in self.orders:
            order.set_epoch(epoch)

    def __len__(self) -> int:
        return sum(len(order) for order in self.orders)

    def __iter__(self) -> Iterator[list[int]]:
        turns = np.repeat(np.arange(len(self.orders)), [len(o) for o in self.orders])
        np.random.default_rng([self.seed, self.epoch]).shuffle(turns)
        batches = [iter(order) for order in self.orders]
        before = self.begun
        for done, k in enumerate(turns.tolist(), start=1):
            batch = next(batches[k])
            if done > before:
                self.begun = done % len(self)
                yield [int(self.starts[k]) + i for i in batch]


class ResumableLoader(DataLoader[MeshBatch]):
    """Batches that go on within an epoch; Lightning keeps the state in checkpoints."""

    def __init__(self, samples: Together, order: MixedOrder) -> None:
        # A generator of its own: an iterator draws a number, wherever it begins.
        own = torch.Generator()
        super().__init__(samples, batch_sampler=order, generator=own)
        self.order = order

    def state_dict(self) -> dict[str, int]:
        """Return how many batches of the epoch have begun."""
        return {"begun": self.order.begun}

    def load_state_dict(self, state_dict: dict[str, int]) -> None:
        """Begin the next epoch after these."""
        self.order.begun = state_dict["begun"]


def in_order(
    sizes: Sequence[int], batch_size: int, share: Share = ALONE
) -> list[list[int]]:
    """Return this process's share of all samples in order, as batches."""
    batches = []
    for start, size in zip(_starts(sizes).tolist(), sizes, strict=True):
        mine = range(start, start + size)[share.rank :: share.of]
        batches += [
            list(mine[i : i + batch_size]) for i in range(0, len(mine), batch_size)
        ]
    return batches


def _starts(sizes: Sequence[int]) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.cumsum([0, *sizes[:-1]], dtype=np.int64)
