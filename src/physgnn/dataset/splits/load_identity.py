"""What tells load paths apart, in whatever dataset they are."""

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.storage.load_records import digest
from physgnn.dataset.storage.store import Store
from physgnn.io.integrity.digest import digest_of
from physgnn.mechanics.loads.paths import LoadPath

CHARACTERS = 16  # of a digest: enough that no two paths share them by chance


def load_digests(store: Store, samples: IntArray) -> tuple[str, ...]:
    """Return what the load paths of some samples are known by, each once, in order.

    Two datasets that were drawn alike, one longer than the other, or one completed
    later, share load paths. Levels do not count.

    Parameters
    ----------
    store : Store
        The dataset.
    samples : (n, 2) integer array
        Its samples, (path, level).
    """
    numbers = np.unique(samples[:, :1])
    return tuple(sorted({_digest(store.load_path(int(i))) for i in numbers}))


def _digest(path: LoadPath) -> str:
    more = [digest(load) for load in path.more]
    return digest_of(path.nodes, path.forces, *more)[:CHARACTERS]
