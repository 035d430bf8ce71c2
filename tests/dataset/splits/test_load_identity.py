"""Load paths are known by what they load, in whatever dataset and at whatever level."""

from pathlib import Path

import numpy as np

from physgnn.dataset.splits.load_identity import load_digests
from physgnn.dataset.storage.store import Store
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import Body, LoadPath, NeoHookean
from physgnn.mechanics.loads.gravity import Gravity

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def made(folder: Path, block: TetMesh, paths: list[LoadPath]) -> Store:
    return Store.create(folder, Body(block, MATERIALS), paths, provenance={})


def test_the_same_loads_are_known_in_another_dataset(
    tmp_path: Path, block: TetMesh
) -> None:
    top = block.point_set("loaded")
    levels = np.array([0.5, 1.0])
    paths = [
        LoadPath(top[[i]], np.array([[0.0, 1e-3 * i, -4e-3]]), levels) for i in range(4)
    ]
    few = made(tmp_path / "few.zarr", block, paths[:3])
    finer = [LoadPath(p.nodes, p.forces, np.array([0.3, 0.7, 1.0])) for p in paths]
    more = made(tmp_path / "more.zarr", block, finer[::-1])
    every = np.array([[i, 0] for i in range(4)])
    known, others = load_digests(few, every[:3]), load_digests(more, every)
    assert len(known) == 3
    assert set(known) < set(others)
    assert load_digests(few, np.array([[1, 0], [1, 1]])) == load_digests(
        few, every[1:2]
    )
    assert load_digests(few, np.empty((0, 2), dtype=np.int64)) == ()


def test_loads_beside_forces_tell_paths_apart(tmp_path: Path, block: TetMesh) -> None:
    down, aside = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    paths = [LoadPath.of(np.ones(1), Gravity(way)) for way in (down, aside, down)]
    store = made(tmp_path / "gravity.zarr", block, paths)
    assert len(load_digests(store, np.array([[0, 0], [1, 0], [2, 0]]))) == 2
