"""A block pressed from above, with made-up displacements that grow with the load."""

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
FACTORS = np.arange(1, 7) / 6


@pytest.fixture(scope="session")
def store(block: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Five load paths of six levels."""
    top, rng = block.point_set("loaded"), np.random.default_rng(1)
    directions = np.array([0.0, 0.0, -1.0]) + 0.4 * rng.uniform(-1, 1, (5, 3))
    paths = [
        LoadPath(top, np.tile(0.06 / len(top) * each, (len(top), 1)), FACTORS)
        for each in directions
    ]
    store = Store.create(
        tmp_path_factory.mktemp("baselines") / "loads.zarr",
        Body(block, MATERIALS, block.point_set("fixed")),
        paths,
        provenance={},
    )
    for i in range(len(paths)):
        full = rng.normal(size=block.points.shape)
        store.write(i, _solution(FACTORS[:, None, None] * full))
    return store


@pytest.fixture(scope="session")
def body(store: Store) -> Body:
    return store.body


def _solution(displacement: np.ndarray) -> Solution:
    return Solution(
        displacement=displacement,
        status=np.zeros(len(FACTORS), dtype=np.int8),
        residual=np.zeros(len(FACTORS)),
        load_factors=FACTORS,
        reached=1.0,
        message="",
        seconds=0.0,
        counts={},
    )
