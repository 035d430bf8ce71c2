"""The loads that a model is fitted to, without their solutions."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store


def strongest_forces(store: Store, samples: IntArray) -> FloatArray:
    """Return each path's strongest load among samples, (n_paths, n_points, 3), N."""
    paths, first = np.unique(samples[:, 0], return_inverse=True)
    top = np.zeros(len(paths), dtype=np.int64)
    np.maximum.at(top, first, samples[:, 1])
    n_points = store.mesh.n_points
    return np.stack(
        [
            store.load_case(int(path), int(level)).on_points(n_points)
            for path, level in zip(paths, top, strict=True)
        ]
    )
