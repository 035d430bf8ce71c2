"""A dataset small enough to train on in a test."""

from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
LOAD_FACTORS = np.arange(1, 5) / 4


@pytest.fixture
def store(block: TetMesh, tmp_path: Path) -> Store:
    """Six load paths of four levels, answered by linear elasticity."""
    top = block.point_set("loaded")
    rng = np.random.default_rng(0)
    paths = [
        LoadPath(top[i : i + 2], rng.normal(size=(2, 3)) * 1e-2, LOAD_FACTORS)
        for i in range(6)
    ]
    fixed = block.point_set("fixed")
    store = Store.create(
        tmp_path / "loads.zarr", Body(block, MATERIALS, fixed), paths, provenance={}
    )
    rest = RestState(Body(block, MATERIALS, fixed))
    for i, path in enumerate(paths):
        cases = [path.case(k).on_points(block.n_points) for k in range(path.n_levels)]
        store.write(i, _solution(rest.solve(np.stack(cases))))
    return store


@pytest.fixture
def split(store: Store) -> Split:
    """Four paths to train on, one to validate, one to test."""
    samples = store.samples()
    path = samples[:, 0]
    return Split("path", samples[path < 4], samples[path == 4], samples[path == 5])


def _solution(displacement: np.ndarray) -> Solution:
    n = len(displacement)
    return Solution(
        displacement=displacement,
        status=np.zeros(n, dtype=np.int8),
        residual=np.zeros(n),
        load_factors=LOAD_FACTORS,
        reached=1.0,
        message="",
        seconds=0.0,
        counts={},
    )
