"""Hundreds of damaged stores: each gives what was in it, or says that it is damaged."""

import json
import random
import shutil
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.dataset import Store, generate, verification_of, verify
from physgnn.errors import InputError
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within
from physgnn.mechanics.materials import NeoHookean

COUNT, SEED = 300, 17
NONSENSE = [None, True, -1, 0, 2.5, 10**12, "", "x", [], {}, [1], {"a": 1}]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with every kind of part."""
    mesh = block_mesh(2)
    top = mesh.point_set("loaded")
    faces = faces_within(mesh, "loaded").astype(np.int64)
    more = (Gravity((0.0, 0.0, -1.0)), SurfacePressure(faces, 5.0))
    paths = [
        LoadPath(top[[k]], 1e-3 * np.ones((1, 3)), np.array([0.5, 1.0]), loads)
        for k, loads in enumerate(((), (), more))
    ]
    store = Store.create(
        tmp_path_factory.mktemp("whole") / "loads.zarr",
        Body(
            mesh,
            {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)},
            mesh.point_set("fixed"),
        ),
        paths,
        provenance={"made": "for a test"},
    )
    generate(store)
    verify(store)
    return store.path


def parts(path: Path) -> Iterator[tuple[str, Any]]:
    """Read all there is in a store, pending paths left out."""
    store = Store.open(path)
    yield "load factors", store.load_factors
    yield "points", store.mesh.points
    yield "cells", store.mesh.cells
    yield "fixed", store.fixed
    yield "body", (store.element, store.materials, store.mesh.content_hash)
    solved = np.setdiff1d(np.arange(store.n_paths), store.pending()).tolist()
    for i in solved:
        load = store.load_path(i)
        yield f"forces {i}", load.forces
        yield f"nodes {i}", load.nodes
        yield f"loads {i}", [type(more).__name__ for more in load.more]
        yield f"displacement {i}", store.displacement(i)
        yield f"status {i}", store.status[i]
    yield "residual", (store.residual.shape, store.reached.shape, store.messages())
    yield "content", len(store.content_hash())
    yield "samples", len(store.samples())
    yield "checked", len(verification_of(store).distance_mm)


def flip(rng: random.Random, file: Path, _: list[Path]) -> None:
    data = bytearray(file.read_bytes())
    for _ in range(rng.randint(1, 3)):
        if data:
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    file.write_bytes(bytes(data))


def cut(rng: random.Random, file: Path, _: list[Path]) -> None:
    file.write_bytes(file.read_bytes()[: rng.randrange(file.stat().st_size or 1)])


def remove(_: random.Random, file: Path, __: list[Path]) -> None:
    file.unlink()


def replace_folder(_: random.Random, file: Path, __: list[Path]) -> None:
    file.unlink()
    file.mkdir()


def exchange(rng: random.Random, file: Path, files: list[Path]) -> None:
    """With another file of the same name, or any."""
    alike = [f for f in files if f.name == file.name and f != file]
    other = rng.choice(alike or files)
    mine, its = file.read_bytes(), other.read_bytes()
    file.write_bytes(its)
    other.write_bytes(mine)


def edit_json(rng: random.Random, _: Path, files: list[Path]) -> None:
    file = rng.choice([f for f in files if f.name == "zarr.json"])
    values = json.loads(file.read_text())
    inner, key = rng.choice(list(places(values)))
    if rng.random() < 0.3:
        del inner[key]
    else:
        inner[key] = rng.choice(NONSENSE)
    file.write_text(json.dumps(values))


def places(values: Any) -> Iterator[tuple[Any, Any]]:
    keys = values if isinstance(values, dict) else range(len(values))
    for key in keys:
        yield values, key
        if isinstance(values[key], dict | list):
            yield from places(values[key])


MUTATIONS: list[Callable[[random.Random, Path, list[Path]], None]] = [
    *(flip, cut, remove, replace_folder, exchange, edit_json, edit_json)
]


def mutated(path: Path, seed: int) -> str:
    """Damage a store; returns what was done."""
    rng = random.Random(seed)
    files = sorted(f for f in path.rglob("*") if f.is_file())
    file = rng.choice(files)
    how = rng.choice(MUTATIONS)
    how(rng, file, files)
    return f"seed {seed}: {how.__name__} {file.relative_to(path)}"


def outcome(path: Path, expected: dict[str, Any] | None, what: str) -> str:
    """Read a damaged store and return how that ended; nothing else may happen."""
    try:
        for name, value in parts(path):
            if expected is not None and not name.startswith(("residual", "sam", "che")):
                np.testing.assert_equal(value, expected[name], f"{what}: {name}")
    except InputError as error:
        assert "\n" not in str(error), what
        assert str(path) in str(error), what
        return "refused"
    except AssertionError:
        raise
    except Exception as error:
        raise AssertionError(f"{what}: {error!r}") from error
    return "as it was"


def test_a_damaged_store_is_refused_or_as_it_was(whole: Path, tmp_path: Path) -> None:
    expected = dict(parts(whole))
    ends = []
    for k in range(COUNT):
        copy = tmp_path / f"{k}.zarr"
        shutil.copytree(whole, copy)
        ends.append(outcome(copy, expected, mutated(copy, SEED * 1000 + k)))
        shutil.rmtree(copy)
    assert ends.count("refused") > COUNT / 2


def test_a_damaged_store_of_version_1_is_refused_or_read(tmp_path: Path) -> None:
    """It has no digests, so that more goes unnoticed; nothing but InputError comes."""
    for k in range(COUNT // 3):
        copy = tmp_path / f"{k}.zarr"
        with zipfile.ZipFile(Path(__file__).with_name("version-1.zarr.zip")) as file:
            file.extractall(copy)
        outcome(copy, None, mutated(copy, SEED * 2000 + k))
        shutil.rmtree(copy)


def test_one_bit_of_every_file(whole: Path, tmp_path: Path) -> None:
    """Each file of each kind, metadata of arrays included, in turn."""
    expected = dict(parts(whole))
    files = sorted(f.relative_to(whole) for f in whole.rglob("*") if f.is_file())
    copy = tmp_path / "loads.zarr"
    shutil.copytree(whole, copy)
    unnoticed = []
    for file in files:
        data = (whole / file).read_bytes()
        middle = len(data) // 2
        changed = bytes([data[middle] ^ 1])
        (copy / file).write_bytes(data[:middle] + changed + data[middle + 1 :])
        if outcome(copy, expected, str(file)) == "as it was":
            unnoticed.append(file)
        (copy / file).write_bytes(data)
    assert all(file.name == "zarr.json" for file in unnoticed), unnoticed
