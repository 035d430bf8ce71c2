"""A small dataset and made-up answers for it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
N_LEVELS = 3


def make_up(store: Store, i: int, *, message: str = "") -> Solution:
    """Return an answer that depends on the path; a message fails its last level."""
    rng = np.random.default_rng(i)
    status = np.zeros(store.n_levels, dtype=np.int8)
    displacement = rng.normal(size=(store.n_levels, store.mesh.n_points, 3))
    if message:
        status[-1], displacement[-1] = Status.LIMIT_POINT, 0.0
    return Solution(
        displacement=displacement,
        status=status,
        residual=rng.uniform(0, 1e-9, store.n_levels),
        load_factors=store.load_factors,
        reached=1.0,
        message=message,
        seconds=rng.uniform(),
        counts={},
    )


@pytest.fixture
def made_up() -> Callable[..., Solution]:
    """Return the function that makes answers up."""
    return make_up


@pytest.fixture
def new_store(block: TetMesh, tmp_path: Path) -> Callable[..., Store]:
    """Make a store of ``n_paths`` pending paths of one node each."""

    def make(
        name: str = "loads.zarr",
        n_paths: int = 5,
        *,
        node_step: int = 1,
        force_n: float = 1e-3,
        mesh: TetMesh = block,
    ) -> Store:
        top = mesh.point_set("loaded")
        paths = [
            LoadPath(
                top[[(k // node_step) % len(top)]],
                force_n * np.array([[1.0, 0.0, -2.0 * (1 + k)]]),
                np.arange(1, N_LEVELS + 1) / N_LEVELS,
            )
            for k in range(n_paths)
        ]
        return Store.create(
            tmp_path / name,
            Body(mesh, MATERIALS, mesh.point_set("fixed")),
            paths,
            provenance={"made": "for a test"},
        )

    return make
