"""Which of several meshes train a network, and which tell when to stop."""

from collections.abc import Sequence

import numpy as np

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError

VALIDATION_SHARE = 1 / 3  # the bounds' coverage is at most n / (n + 1) of n such meshes
NONE = np.empty((0, 2), dtype=np.int64)


def split_meshes(stores: Sequence[Store], seed: int = 0) -> list[Split]:
    """Return a split a store: all of its samples train, or all of them validate.

    Parameters
    ----------
    stores : sequence of Store
        Two or more, each on a mesh of its own. The first always trains.
    seed : int
        Of the draw.

    Raises
    ------
    InputError
        If there is one store only, or two have the same mesh.
    """
    if len(stores) < 2:
        raise InputError("to hold out whole meshes takes two stores or more (got 1)")
    if len({store.mesh.content_hash for store in stores}) < len(stores):
        raise InputError("each store must be on a mesh of its own: two are on the same")
    n_held_out = max(1, round(VALIDATION_SHARE * len(stores)))
    others = 1 + np.random.default_rng(seed).permutation(len(stores) - 1)
    held_out = set(others[:n_held_out].tolist())
    return [
        Split("mesh", NONE, store.samples(), NONE)
        if k in held_out
        else Split("mesh", store.samples(), NONE, NONE)
        for k, store in enumerate(stores)
    ]
