"""How much memory a training step takes, and what to do if that's too much.

What a step needs is what the backward pass keeps of the forward pass. That grows with
the batch in a straight line; a batch that doesn't fit is computed in parts, whose
gradients add up to the same.
"""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.autograd.graph import saved_tensors_hooks

from physgnn.errors import InputError
from physgnn.learning.network import Network

MEGABYTE = 2**20
PEAK = 2.5  # of a step over what it keeps, memory that the allocator holds included
SPARED = 3  # about so many times less is kept if all that can be is computed twice


@dataclass(frozen=True)
class Memory:
    """Bytes kept for the backward pass: a fixed part and one a sample."""

    fixed: int
    a_sample: int

    def samples_within(self, limit: int) -> int:
        """Return how many samples at once stay within a limit in bytes."""
        return max(limit - self.fixed, 0) // max(self.a_sample, 1)


def kept_bytes(forward: Callable[[], Tensor]) -> int:
    """Return the bytes that autograd keeps of a forward pass, weights not counted."""
    storages: dict[int, int] = {}

    def note(tensor: Tensor) -> Tensor:
        # Sparse matrices are the graph's: kept once, whatever the batch.
        if tensor.layout is torch.strided and not isinstance(
            tensor, torch.nn.Parameter
        ):
            storage = tensor.untyped_storage()
            storages[storage.data_ptr()] = storage.nbytes()
        return tensor.detach()  # itself would hold on to what it was made from

    with saved_tensors_hooks(note, lambda tensor: tensor):
        forward()
    return sum(storages.values())


def measure(forward: Callable[[int], Tensor]) -> Memory:
    """Measure a forward pass of one sample and one of two."""
    one, two = (kept_bytes(lambda n=n: forward(n)) for n in (1, 2))  # type: ignore[misc]
    a_sample = max(two - one, 0)
    return Memory(max(one - a_sample, 0), a_sample)


def samples_at_once(
    model: Network,
    forward: Callable[[int], Tensor],
    *,
    batch_size: int,
    limit_mb: float,
) -> int:
    """Return how many samples of a batch to compute at once; spare memory if need be.

    Parameters
    ----------
    model : Network
        Its `spare_memory` is set: only if a whole batch wouldn't fit otherwise.
    forward : callable
        From a number of samples to their loss.
    batch_size : int
        The most that is wanted.
    limit_mb : float
        What a step may take, MB.

    Raises
    ------
    InputError
        If even one sample doesn't fit.
    """
    limit = int(limit_mb * MEGABYTE / PEAK)
    model.spare_memory(True)
    memory = measure(forward)
    if memory.samples_within(limit // SPARED) >= batch_size:
        model.spare_memory(False)
        if measure(forward).samples_within(limit) >= batch_size:
            return batch_size
        model.spare_memory(True)
    fit = memory.samples_within(limit)
    if fit < 1:
        needed = PEAK * (memory.fixed + memory.a_sample) / MEGABYTE
        raise InputError(
            f"training needs {needed:.0f} MB for one sample, memory_mb is "
            f"{limit_mb:.0f}: raise it, or take a smaller width or a coarser mesh"
        )
    parts = -(-batch_size // fit)  # rounded up
    return -(-batch_size // parts)
