"""A small dataset of pushes on the bundled brain, kept in a temporary folder."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from _common import brain, materials

import physgnn as pg
from physgnn.dataset import generate

N_PATHS, N_LEVELS = 24, 10


@cache
def dataset() -> pg.Store:
    """Return load paths, each pushing some of the exposed points in its own direction."""
    mesh = brain(400, 2500.0)
    rng = np.random.default_rng(0)
    loaded = mesh.point_set("loaded")
    paths = []
    for _ in range(N_PATHS):
        middle = mesh.points[rng.choice(loaded)]
        nodes = loaded[
            np.argsort(np.linalg.norm(mesh.points[loaded] - middle, axis=1))[:15]
        ]
        direction = np.array([-0.55, -0.35, -0.75]) + rng.normal(scale=0.3, size=3)
        forces = np.tile(4.0 / 15 * direction, (15, 1)) * rng.uniform(0.5, 1.5, (15, 1))
        factors = np.arange(1, N_LEVELS + 1) / N_LEVELS
        paths.append(pg.LoadPath(nodes=nodes, forces=forces, load_factors=factors))
    store = pg.Store.create(Path(tempfile.mkdtemp()) / "loads.zarr", pg.Body(mesh, materials(), mesh.point_set("fixed")), paths, provenance={})  # fmt: skip
    generate(store)
    return store


@cache
def linear_parts() -> np.ndarray:
    """Return the linear solution of every path at load factor 1, (n_paths, n, 3)."""
    store = dataset()
    found = []
    for i in range(store.n_paths):
        path = store.load_path(i)
        little = pg.LoadPath(nodes=path.nodes, forces=path.forces, load_factors=[1e-4])
        solution = pg.solve(
            store.mesh, little, materials=store.materials, fixed=store.fixed
        )
        found.append(1e4 * solution.displacement[0])
    return np.stack(found)
