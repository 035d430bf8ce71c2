"""The states of all generators of random numbers that a network may draw from."""

import random
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import torch
from lightning.pytorch import Callback, LightningModule, Trainer


class RandomState(Callback):
    """Keeps the generators of torch, NumPy and Python in the checkpoint of a training.

    A resume draws on from there, so that a network that draws from these during
    training (`torch.nn.Dropout` does) gets the numbers that it would have got.
    """

    def __init__(self) -> None:
        self._found: dict[str, Any] = {}

    def on_train_batch_start(self, *_: Any) -> None:
        """Set what a checkpoint held, before the first step of a resume."""
        if self._found:
            set_random_state(self._found)
            self._found = {}

    def on_train_end(self, _: Trainer, __: LightningModule) -> None:
        """Forget what a checkpoint held, if no step followed."""
        self._found = {}

    def state_dict(self) -> dict[str, Any]:
        """Return the states."""
        return random_state()

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Take the states before a resume."""
        self._found = state_dict


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Draw from a seed within; afterwards all generators are as they were."""
    before = random_state()
    torch.manual_seed(seed)
    np.random.seed(seed % 2**32)  # noqa: NPY002
    random.seed(seed)
    try:
        yield
    finally:
        set_random_state(before)


def random_state() -> dict[str, Any]:
    """Return the states as tensors, numbers and text."""
    numpy: tuple[Any, ...] = np.random.get_state(legacy=True)  # type: ignore[assignment]  # noqa: NPY002
    name, keys, *rest = numpy
    version, internal, gauss = random.getstate()
    return {
        "torch": torch.get_rng_state(),
        "cuda": torch.cuda.get_rng_state_all() if torch.cuda.is_available() else [],
        "numpy": [name, torch.tensor(keys.astype(np.int64)), *rest],
        "python": [version, list(internal), gauss],
    }


def set_random_state(state: dict[str, Any]) -> None:
    """Set what `random_state` returned."""
    torch.set_rng_state(state["torch"])
    if state["cuda"] and len(state["cuda"]) == torch.cuda.device_count():
        torch.cuda.set_rng_state_all(state["cuda"])
    name, keys, *rest = state["numpy"]
    np.random.set_state((name, keys.numpy().astype(np.uint32), *rest))  # noqa: NPY002
    version, internal, gauss = state["python"]
    random.setstate((version, tuple(internal), gauss))
