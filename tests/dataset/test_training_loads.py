"""The strongest load of every path among samples."""

from collections.abc import Callable

import numpy as np

from physgnn.dataset.storage.store import Store
from physgnn.dataset.training_loads import strongest_forces


def test_each_path_gives_its_highest_level(new_store: Callable[..., Store]) -> None:
    store = new_store(n_paths=3)
    samples = np.array([[2, 1], [0, 0], [2, 0], [0, 2]])
    found = strongest_forces(store, samples)
    for field, (path, level) in zip(found, [(0, 2), (2, 1)], strict=True):
        expected = store.load_case(path, level).on_points(store.mesh.n_points)
        np.testing.assert_array_equal(field, expected)
