"""A dataset whose displacement is known in closed form."""

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
N_PATHS, N_LEVELS = 5, 6


def shape(mesh: TetMesh, path: int) -> np.ndarray:
    """The displacement of a path at full load, zero at the bottom, mm."""
    x, y, z = mesh.points.T
    lean = np.stack([np.sin(path + y / 7), np.cos(path + x / 5), -1.0 - 0 * z], axis=1)
    return 0.3 * z[:, None] * lean


@pytest.fixture(scope="session")
def store(block: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Every path grows in proportion to its load factor."""
    top, factors = block.point_set("loaded"), np.arange(1, N_LEVELS + 1) / N_LEVELS
    rng = np.random.default_rng(0)
    paths = [
        LoadPath(top, rng.normal(size=(len(top), 3)) * 1e-3, factors)
        for _ in range(N_PATHS)
    ]
    store = Store.create(
        tmp_path_factory.mktemp("evaluation") / "loads.zarr",
        Body(block, MATERIALS, block.point_set("fixed")),
        paths,
        provenance={"preset": "paper-2"},
    )
    for i in range(N_PATHS):
        store.write(
            i,
            Solution(
                displacement=factors[:, None, None] * shape(block, i),
                status=np.zeros(N_LEVELS, dtype=np.int8),
                residual=np.zeros(N_LEVELS),
                load_factors=factors,
                reached=1.0,
                message="",
                seconds=2.0,
                counts={},
            ),
        )
    return store
