"""A small body with a dataset of finite-element answers."""

import numpy as np
import pytest

from physgnn.dataset.generation.pending_paths import generate
from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
N_PATHS = 12


@pytest.fixture(scope="session")
def store(block: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Paths that press the top down, each a little askew."""
    top = block.point_set("loaded")
    rng = np.random.default_rng(1)
    paths = []
    for _ in range(N_PATHS):
        direction = np.array([0.0, 0.0, -1.0]) + 0.4 * rng.uniform(-1, 1, 3)
        forces = np.tile(0.06 / len(top) * direction, (len(top), 1))
        paths.append(LoadPath(top, forces, np.arange(1, 4) / 3))
    store = Store.create(
        tmp_path_factory.mktemp("prediction") / "loads.zarr",
        Body(block, MATERIALS, block.point_set("fixed")),
        paths,
        provenance={},
    )
    generate(store)
    assert len(store.samples()) == 3 * N_PATHS
    return store


@pytest.fixture(scope="session")
def body(store: Store) -> Body:
    return store.body


@pytest.fixture(scope="session")
def parts(store: Store) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples to train on, to calibrate on, and to test with; whole paths."""
    samples = store.samples()
    return tuple(
        samples[(samples[:, 0] >= first) & (samples[:, 0] < last)]
        for first, last in ((0, 4), (4, 8), (8, 12))
    )
