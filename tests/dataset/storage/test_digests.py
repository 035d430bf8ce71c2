"""What was changed, exchanged or cut out of a store is noticed when it is read."""

import json
import logging
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zarr

from physgnn.dataset import Store, generate, verification_of, verify
from physgnn.errors import InputError
from physgnn.mechanics.equilibrium.solution import Solution

NewStore = Callable[..., Store]
OLD = Path(__file__).with_name("version-1.zarr.zip")
OLD_CONTENT = "a425d4ec006a3b839f32f2610b97a2199fee8796a62fc0f23e57e3d3ffdcef7c"


def edit(store: Path, change: Callable[[dict[str, Any]], None]) -> None:
    """Change the attributes of a store as a text editor would."""
    values = json.loads((store / "zarr.json").read_text())
    change(values["attributes"])
    (store / "zarr.json").write_text(json.dumps(values))


def swap(one: Path, two: Path) -> None:
    spare = one.with_name("spare")
    one.rename(spare)
    two.rename(one)
    spare.rename(two)


@pytest.fixture
def filled(new_store: NewStore, made_up: Callable[..., Solution]) -> Store:
    store = new_store()
    for i in range(store.n_paths):
        store.write(i, made_up(store, i))
    return store


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """A store as version 0.1 made it, its second path pending again."""
    zipfile.ZipFile(OLD).extractall(tmp_path / "old.zarr")
    return tmp_path / "old.zarr"


def test_exchanged_displacements(filled: Store) -> None:
    """Each chunk is whole and its checksum right, but it is another path's."""
    chunks = filled.path / "result/displacement/c"
    swap(chunks / "1", chunks / "3")
    again = Store.open(filled.path)
    for i in (1, 3):
        with pytest.raises(InputError, match=f"path {i} is damaged .*exchanged"):
            again.displacement(i)
    assert again.displacement(2).shape[0] == again.n_levels


def test_exchanged_paths(filled: Store) -> None:
    """All results of two paths change places, digests and status with them."""
    for _, array in zarr.open_group(filled.path)["result"].arrays():  # type: ignore[union-attr]
        array[1], array[3] = array[3], array[1]
    with pytest.raises(InputError, match=r"path 3 is damaged .*exchanged"):
        Store.open(filled.path).displacement(3)


def test_a_path_of_another_store(
    filled: Store, new_store: NewStore, made_up: Callable[..., Solution]
) -> None:
    other = new_store("other.zarr", force_n=2e-3)
    other.write(0, made_up(other, 0))
    group, others = zarr.open_group(filled.path), zarr.open_group(other.path)
    for name, array in others["result"].arrays():  # type: ignore[union-attr]
        group[f"result/{name}"][0] = array[0]  # type: ignore[index]
    with pytest.raises(InputError, match=r"path 0 is damaged .*exchanged"):
        Store.open(filled.path).displacement(0)


@pytest.mark.parametrize("name", ["status", "residual", "reached", "message"])
def test_a_row_beside_the_displacement(filled: Store, name: str) -> None:
    group = zarr.open_group(filled.path)
    group[f"result/{name}"][2] = 3  # type: ignore[index]
    with pytest.raises(InputError, match=r"path 2 is damaged .*changed"):
        Store.open(filled.path).displacement(2)


def stiffer(attributes: dict[str, Any]) -> None:
    attributes["materials"]["0"]["youngs_modulus_pa"] *= 2


@pytest.mark.parametrize(
    "change",
    [
        stiffer,
        lambda a: a.update(element="tet4-averaged"),
        lambda a: a.update(n_paths=4),
        lambda a: a.pop("root"),
        lambda a: a.update(version=1),
        lambda a: a["arrays"].pop("fixed"),
        lambda a: a.pop("provenance"),
    ],
)
def test_edited_attributes(
    filled: Store, change: Callable[[dict[str, Any]], None]
) -> None:
    edit(filled.path, change)
    with pytest.raises(InputError, match=r"attributes \(zarr.json\) are not as they"):
        Store.open(filled.path)


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("fixed", lambda s: s.fixed),
        ("mesh/point_sets/loaded", lambda s: s.mesh),
        ("mesh/points", lambda s: s.mesh),
        ("loads/forces", lambda s: s.load_path(0)),
        ("load_factors", lambda s: s),
    ],
)
def test_an_array_of_the_definition(
    filled: Store, name: str, read: Callable[[Store], object]
) -> None:
    """Written again by Zarr, with a right checksum."""
    array = zarr.open_group(filled.path)[name]
    array[-1] = array[-1] * 0.5 if name != "fixed" else 5  # type: ignore[index, operator]
    with pytest.raises(InputError, match=f"'{name}' is damaged .*changed"):
        read(Store.open(filled.path))


def test_pending_rows_that_look_solved(new_store: NewStore) -> None:
    """The fill value of the status is edited: nothing was solved all the same."""
    path = new_store().path
    file = path / "result/status/zarr.json"
    file.write_text(file.read_text().replace('"fill_value": 4', '"fill_value": 0'))
    with pytest.raises(InputError, match=r"path 0 is damaged \(chunk missing"):
        Store.open(path).displacement(0)


def test_what_was_checked_against_newton(new_store: NewStore) -> None:
    store = new_store(n_paths=6)
    generate(store)
    found = verify(store)
    assert len(found.samples) == 2
    rows = zarr.open_group(store.path)["verification/distance_mm"]
    rows[5] = 0.0  # type: ignore[index]
    with pytest.raises(InputError, match="check of load path 5 is not as it was"):
        verification_of(Store.open(store.path))


def test_a_store_of_version_1(old: Path, caplog: pytest.LogCaptureFixture) -> None:
    """It opens with one note, gives what is in it, resumes, and keeps its hash."""
    with caplog.at_level(logging.WARNING):
        store, again = Store.open(old), Store.open(old)
    assert len(caplog.records) == 1
    assert "version-1" not in caplog.text
    assert "has no digest" in caplog.text
    assert store.pending().tolist() == [1]
    assert [type(load).__name__ for load in store.load_path(2).more] == [
        *("Gravity", "SurfacePressure")
    ]
    assert len(verification_of(again).samples) == 1
    assert generate(store).solved == 1
    assert store.content_hash() == OLD_CONTENT
    assert Store.open(old).displacement(1).any()
    verify(store)


def test_exchanged_displacements_of_version_1(old: Path) -> None:
    chunks = old / "result/displacement/c"
    swap(chunks / "0", chunks / "2")
    with pytest.raises(InputError, match=r"path 0 is damaged .*exchanged"):
        Store.open(old).displacement(0)


@pytest.mark.parametrize(
    "change",
    [
        lambda a: a.pop("n_paths"),
        lambda a: a.update(n_paths="3"),
        lambda a: a.update(materials=[]),
        lambda a: a.update(point_sets=[1]),
        lambda a: a.update(version=True),
    ],
)
def test_nonsense_in_version_1(
    old: Path, change: Callable[[dict[str, Any]], None]
) -> None:
    edit(old, change)
    with pytest.raises(InputError, match=str(old)):
        Store.open(old)


@pytest.mark.parametrize(
    ("change", "read"),
    [
        (lambda a: a.update(materials={"brain": {}}), lambda s: s.materials),
        (lambda a: a["materials"]["0"].update(law=[]), lambda s: s.materials),
        (lambda a: a["more_loads"][0].pop("kind"), lambda s: s.load_path(2)),
        (lambda a: a["more_loads"][0].update(kind=3), lambda s: s.load_path(2)),
        (lambda a: a["more_loads"][0].update(more=3), lambda s: s.load_path(2)),
        (lambda a: a["more_loads"].pop(), lambda s: s.load_path(2)),
        (lambda a: a.update(point_sets=["nose"]), lambda s: s.mesh),
        (lambda a: a.update(mesh_hash="0" * 64), lambda s: s.mesh),
        (lambda a: a.update(n_points=26), lambda s: s.displacement(0)),
    ],
)
def test_parts_of_version_1_that_do_not_fit(
    old: Path,
    change: Callable[[dict[str, Any]], None],
    read: Callable[[Store], object],
) -> None:
    edit(old, change)
    store = Store.open(old)
    with pytest.raises(InputError, match=str(old)):
        read(store)


def test_a_shape_that_would_use_up_the_memory(old: Path) -> None:
    file = old / "fixed/zarr.json"
    values = json.loads(file.read_text())
    values["shape"] = [10**11]
    file.write_text(json.dumps(values))
    with pytest.raises(InputError, match=r"'fixed' is damaged .*bytes of"):
        _ = Store.open(old).fixed


def test_times_are_no_content(filled: Store) -> None:
    """They are covered, but two runs that found the same have the same content."""
    before = filled.content_hash()
    zarr.open_group(filled.path)["result/seconds"][0] = 1.0  # type: ignore[index]
    again = Store.open(filled.path)
    assert again.content_hash() == before
    with pytest.raises(InputError, match=r"path 0 is damaged .*changed"):
        again.displacement(0)
