"""POD modes of what an expansion misses, on one body: found from solved samples."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from physgnn.arrays import IntArray
from physgnn.learning.graph import as_float32
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.pod_galerkin.pod import leading_modes

if TYPE_CHECKING:
    from physgnn.dataset.storage.store import Store

MAX_SNAPSHOTS = 600  # more don't change the modes that pay, and cost memory


def fitted_modes(
    encode: Callable[[LoadCase], Tensor],
    axes: Tensor,
    store: "Store",
    samples: IntArray,
    n_modes: int,
) -> tuple[Tensor, Tensor]:
    """Return POD modes of what the expansion misses, and what a network sees of them.

    Parameters
    ----------
    encode : callable
        From a load to the columns displacement, u₁, u₂ and others, in the body's axes.
    axes : (3, 3) tensor
        Those axes.
    store : Store
        With the solutions.
    samples : (n, 2) integer array
        Which of them.
    n_modes : int
        How many modes.

    Returns
    -------
    modes : (n_modes, n_points, 3) tensor
        Over the size of u₂.
    scale : (3 · n_modes,) tensor
        The root mean square products of u₁, u₂ and what is missed with the modes.
    """
    every = max(len(samples) // MAX_SNAPSHOTS, 1)
    missed, terms = [], []
    for path, level in samples[::every]:
        x = encode(store.load_case(int(path), int(level)))
        truth = torch.tensor(store.displacement(int(path))[int(level)])
        expanded, first, second = torch.split(x[:, :9], 3, dim=-1)
        missed.append((truth @ axes.cpu().T - expanded) / size(second[None])[0])
        terms.append(torch.stack([first, second, missed[-1]]))
    modes = as_float32(leading_modes(torch.stack(missed).numpy(), n_modes))
    projected = products(torch.stack(terms), modes)
    return modes, projected.square().mean(0).sqrt().clamp_min(1e-12)


def products(terms: Tensor, modes: Tensor) -> Tensor:
    """Return (batch, 3 · modes) products of three fields with the modes."""
    return (terms.flatten(2) @ modes.flatten(1).T).flatten(1)


def size(field: Tensor) -> Tensor:
    """Return the root mean square length of a field over its points, (batch, 1, 1)."""
    return field.square().sum(dim=-1, keepdim=True).mean(dim=1, keepdim=True).sqrt()
