"""The store gives back what was put in, and says so when the disk did not."""

import json
import os
import pickle
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution, Status
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean

NewStore = Callable[..., Store]
MadeUp = Callable[..., Solution]
MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


def flip_a_bit(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(bytes(data))


def test_definitions_survive(new_store: NewStore, block: TetMesh) -> None:
    store = Store.open(new_store().path)
    assert store.mesh.content_hash == block.content_hash
    assert sorted(store.mesh.point_sets) == ["fixed", "loaded"]
    assert np.array_equal(store.fixed, block.point_set("fixed"))
    assert store.materials == MATERIALS
    assert store.provenance == {"made": "for a test"}
    assert (store.n_paths, store.n_levels) == (5, 3)
    path = store.load_path(4)
    assert path.nodes.tolist() == [block.point_set("loaded")[4]]
    assert path.forces.tolist() == [[1e-3, 0.0, -1e-2]]
    np.testing.assert_allclose(store.load_case(4, 1).forces, path.forces * 2 / 3)


def test_paths_of_different_width(block: TetMesh, tmp_path: Path) -> None:
    top = block.point_set("loaded")
    paths = [LoadPath(top[:n], np.full((n, 3), n), np.array([1.0])) for n in (3, 1, 2)]
    store = Store.create(tmp_path / "s", Body(block, MATERIALS), paths, provenance={})
    for i, path in enumerate(paths):
        assert np.array_equal(store.load_path(i).nodes, path.nodes)
        assert np.array_equal(store.load_path(i).forces, path.forces)


def test_results_survive(new_store: NewStore, made_up: MadeUp) -> None:
    store = new_store()
    assert store.pending().tolist() == [0, 1, 2, 3, 4]
    whole, broken = made_up(store, 3), made_up(store, 1, message="limit point — at 0.9")
    store.write(3, whole)
    store.write(1, broken)
    again = Store.open(store.path)
    assert again.pending().tolist() == [0, 2, 4]
    assert again.samples().tolist() == [[1, 0], [1, 1], [3, 0], [3, 1], [3, 2]]
    assert np.array_equal(again.displacement(3), whole.displacement.astype("f4"))
    assert again.displacement(3).dtype == np.float32
    assert again.message(1) == "limit point — at 0.9"
    assert again.message(3) == ""
    assert again.messages() == {1: "limit point — at 0.9"}
    assert again.status[1, 2] == Status.LIMIT_POINT
    assert again.seconds[3] == whole.seconds
    assert np.isnan(again.residual[0]).all()


def test_a_long_message_is_cut_between_characters(
    new_store: NewStore, made_up: MadeUp
) -> None:
    store = new_store()
    store.write(0, made_up(store, 0, message="a" + "é" * 200))
    assert store.message(0) == "a" + "é" * 127


def test_a_path_without_status_stays_pending(
    new_store: NewStore, made_up: MadeUp
) -> None:
    store = new_store()
    store.write(2, made_up(store, 2))
    (store.path / "result/status/c/2/0").unlink()
    assert 2 in store.pending()
    with pytest.raises(InputError, match="load path 2 has no result yet"):
        store.displacement(2)


def test_hash_ignores_order_and_time(new_store: NewStore, made_up: MadeUp) -> None:
    one, two = new_store("one"), new_store("two")
    empty = one.content_hash()
    for i in range(5):
        one.write(i, made_up(one, i))
        two.write(4 - i, made_up(two, 4 - i))
    assert one.content_hash() == two.content_hash() != empty
    two.write(0, made_up(two, 17))
    assert one.content_hash() != two.content_hash()
    assert one.definition_hash == two.definition_hash


def test_the_cache_is_bounded(new_store: NewStore, made_up: MadeUp) -> None:
    store = new_store()
    for i in range(5):
        store.write(i, made_up(store, i))
    two_paths = 2 * store.displacement(0).nbytes
    small = Store.open(store.path, cache_bytes=two_paths)
    assert small.displacement(0) is small.displacement(0)
    first = small.displacement(0)
    small.displacement(1), small.displacement(2)
    assert small.displacement(0) is not first
    with pytest.raises(ValueError, match="read-only"):
        first[0] = 0


def test_another_process_can_have_it(new_store: NewStore) -> None:
    store = new_store()
    assert pickle.loads(pickle.dumps(store)).path == store.path


@pytest.mark.parametrize("damage", ["flip", "cut", "empty", "gone"])
def test_a_damaged_chunk_is_named(
    new_store: NewStore, made_up: MadeUp, damage: str
) -> None:
    store = new_store()
    store.write(2, made_up(store, 2))
    chunk = store.path / "result/displacement/c/2/0/0/0"
    if damage == "flip":
        flip_a_bit(chunk)
    elif damage == "gone":
        chunk.unlink()
    else:
        os.truncate(chunk, 0 if damage == "empty" else 100)
    pattern = "load path 2 is damaged .* delete result/status/c/2/0 .* simulate again"
    with pytest.raises(InputError, match=pattern) as raised:
        store.displacement(2)
    assert "\n" not in str(raised.value)


def test_a_damaged_row_is_named_where_all_are_read(
    new_store: NewStore, made_up: MadeUp
) -> None:
    store = new_store()
    for i in range(3):
        store.write(i, made_up(store, i))
    flip_a_bit(store.path / "result/status/c/1/0")
    with pytest.raises(InputError, match=r"path 1 is damaged .* result/status/c/1/0"):
        Store.open(store.path).pending()


@pytest.mark.parametrize("name", ["status", "displacement"])
def test_an_array_without_its_record_is_no_matter_of_one_path(
    new_store: NewStore, made_up: MadeUp, name: str
) -> None:
    """What to delete was named, and deleting it did not help."""
    store = new_store()
    store.write(2, made_up(store, 2))
    (store.path / "result" / name / "zarr.json").unlink()
    with pytest.raises(InputError, match="bring the store back from a copy"):
        Store.open(store.path).displacement(2)


@pytest.mark.parametrize("name", ["points/c/0/0", "cells/c/0/0", "region/c/0"])
def test_a_damaged_mesh_is_named(new_store: NewStore, name: str) -> None:
    path = new_store().path
    flip_a_bit(path / "mesh" / name)
    with pytest.raises(InputError, match=f"'mesh/{name.split('/')[0]}' is damaged"):
        _ = Store.open(path).mesh


def test_another_mesh_is_noticed(new_store: NewStore) -> None:
    path = new_store().path
    edit_attributes(path, mesh_hash="0" * 64)
    with pytest.raises(InputError, match=r"zarr\.json\) are not as they were"):
        Store.open(path)


def edit_attributes(path: Path, **changes: object) -> None:
    metadata = json.loads((path / "zarr.json").read_text())
    metadata["attributes"].update(changes)
    (path / "zarr.json").write_text(json.dumps(metadata))


def test_not_a_store(new_store: NewStore, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        Store.open(tmp_path / "nothing")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match=r"no readable zarr\.json"):
        Store.open(tmp_path / "folder")
    path = new_store().path
    edit_attributes(path, format="weather")
    with pytest.raises(InputError, match="not a dataset store"):
        Store.open(path)


def test_another_version(new_store: NewStore) -> None:
    path = new_store().path
    edit_attributes(path, version=99)
    with pytest.raises(InputError, match=r"version 99.*reads version 1 and 2"):
        Store.open(path)


def test_broken_metadata(new_store: NewStore) -> None:
    path = new_store().path
    (path / "zarr.json").write_text("{")
    with pytest.raises(InputError, match=r"no readable zarr\.json"):
        Store.open(path)
    other = new_store("other").path
    shutil.rmtree(other / "load_factors")
    with pytest.raises(InputError, match="'load_factors' is damaged"):
        Store.open(other)


def test_create_refuses(block: TetMesh, tmp_path: Path) -> None:
    top, factors = block.point_set("loaded"), np.array([0.5, 1.0])
    good = LoadPath(top[:1], np.ones((1, 3)), factors)
    other = LoadPath(top[:1], np.ones((1, 3)), np.array([1.0]))
    held = LoadPath(block.point_set("fixed")[:1], np.ones((1, 3)), factors)
    fixed = block.point_set("fixed")
    for paths, materials, message in (
        ([], MATERIALS, "one load path or more"),
        ([good, other], MATERIALS, r"same load factors \(path 1"),
        ([held], MATERIALS, "is fixed"),
        ([good], {0: MATERIALS[0]}, "region 1 has no material"),
    ):
        with pytest.raises(InputError, match=message):
            Store.create(
                tmp_path / "s", Body(block, materials, fixed), paths, provenance={}
            )
    assert list(tmp_path.iterdir()) == []  # nothing half-written


def test_create_never_overwrites(new_store: NewStore) -> None:
    new_store()
    with pytest.raises(InputError, match="exists already"):
        new_store()


def test_resume_opens_what_asks_the_same(new_store: NewStore) -> None:
    store = new_store()
    paths = [store.load_path(i) for i in range(5)]
    mesh, fixed = store.mesh, store.fixed
    asked = Body(mesh, MATERIALS, fixed)
    spare = Body(mesh, {**MATERIALS, 7: MATERIALS[0]}, fixed)
    assert Store.resume(store.path, spare, paths, provenance={}).path == store.path
    stiffer = Body(mesh, {**MATERIALS, 1: NeoHookean(9000.0, 0.3)}, fixed)
    for body, some in (
        (asked, paths[:4]),
        (stiffer, paths),
        (Body(mesh, MATERIALS, fixed[1:]), paths),
    ):
        with pytest.raises(InputError, match="made for another mesh, load, mat"):
            Store.resume(store.path, body, some, provenance={})
    other = store.path.with_name("other")
    assert len(Store.resume(other, asked, paths, provenance={}).pending()) == 5


def test_paths_for_training_alone_are_of_the_definition(
    new_store: NewStore, block: TetMesh, tmp_path: Path
) -> None:
    plain = new_store()
    paths = [plain.load_path(i) for i in range(plain.n_paths)]
    body = Body(block, MATERIALS)
    marked = tmp_path / "marked.zarr"
    store = Store.create(marked, body, paths, provenance={}, training_paths=2)
    assert (plain.training_paths, store.training_paths) == (0, 2)
    assert Store.open(marked).training_paths == 2
    assert store.definition_hash != plain.definition_hash
    with pytest.raises(InputError, match="made for another"):
        Store.resume(marked, body, paths, provenance={})
    record = json.loads((marked / "zarr.json").read_text())
    record["attributes"]["training_paths"] = 0  # so that they would be held out
    (marked / "zarr.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match="not as they were written"):
        Store.open(marked)
