"""A dataset of a body that answers in proportion to its load."""

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

N_PATHS, N_LEVELS = 8, 4


@pytest.fixture(scope="session")
def store(block: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Store:
    rng, factors = np.random.default_rng(0), np.arange(1, N_LEVELS + 1) / N_LEVELS
    top = block.point_set("loaded")[:2]
    response = rng.normal(size=(3 * len(top), block.n_points, 3))
    response[:, block.point_set("fixed")] = 0.0
    paths = [
        LoadPath(top, rng.normal(size=(len(top), 3)), factors) for _ in range(N_PATHS)
    ]
    store = Store.create(
        tmp_path_factory.mktemp("classical") / "loads.zarr",
        Body(
            block,
            {region: NeoHookean(3000.0, 0.3) for region in (0, 1)},
            block.point_set("fixed"),
        ),
        paths,
        provenance={},
    )
    for i, path in enumerate(paths):
        full = np.tensordot(path.forces.ravel(), response, axes=1)
        store.write(
            i,
            Solution(
                displacement=factors[:, None, None] * full,
                status=np.zeros(N_LEVELS, dtype=np.int8),
                residual=np.zeros(N_LEVELS),
                load_factors=factors,
                reached=1.0,
                message="",
                seconds=1.0,
                counts={},
            ),
        )
    return store
