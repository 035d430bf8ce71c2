"""Elements, materials and all loads survive on disk and count in the hashes."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.dataset import Store, generate, verify
from physgnn.dataset.exchange.exporting import (
    export_arrays,
    export_febio,
    export_series,
)
from physgnn.dataset.storage.load_records import (
    digest,
    distinct,
    from_record,
    to_record,
)
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.vtk.series import read_series
from physgnn.mechanics import (
    Gravity,
    Load,
    LoadPath,
    MooneyRivlin,
    Ogden,
    PrescribedDisplacement,
    Solver,
    SurfacePressure,
    VolumeGrowth,
    faces_within,
)
from physgnn.mechanics.body import Body

FACTORS = np.array([0.5, 1.0])
MATERIALS = {
    0: Ogden((1684.0, 10.0), (-4.7, 2.0), 20_000.0),
    1: MooneyRivlin(300.0, 100.0, 20_000.0),
}


def loads_on(mesh: TetMesh) -> list[Load]:
    top = mesh.point_set("loaded")
    return [
        SurfacePressure(faces_within(mesh, "loaded"), 200.0),
        Gravity((0, 0.5, -1), fluid_level_mm=4.0),
        Gravity((0, 0, -1)),
        PrescribedDisplacement(top[[0, 5]], np.array([[0, 0, -0.5], [0, 0.1, -0.4]])),
    ]


def paths_on(mesh: TetMesh) -> list[LoadPath]:
    """Combined with forces, alone, and forces alone; some loads are shared."""
    pressure, sag, weight, push = loads_on(mesh)
    node = mesh.point_set("loaded")[[8]]
    force = np.array([[1e-3, 0, -2e-3]])
    return [
        LoadPath(node, force, FACTORS, (pressure, sag)),
        LoadPath.of(FACTORS, weight, push),
        LoadPath.of(FACTORS, replace(weight)),
        LoadPath(node, force, FACTORS),
    ]


def make(mesh: TetMesh, path: Path, **changes: Any) -> Store:
    asked = {
        "paths": paths_on(mesh),
        "materials": MATERIALS,
        "fixed": mesh.point_set("fixed"),
        "element": "tet4-averaged",
        **changes,
    }
    paths = asked.pop("paths")
    return Store.create(path, Body(mesh, **asked), paths, provenance={})


@pytest.fixture(scope="module")
def solved(block: TetMesh, tmp_path_factory: pytest.TempPathFactory) -> Store:
    store = make(block, tmp_path_factory.mktemp("more") / "s.zarr")
    assert not generate(store).errors
    return Store.open(store.path)


def same(one: Load, other: Load) -> bool:
    return type(one) is type(other) and digest(one) == digest(other)


def test_records_are_json_and_come_back(block: TetMesh) -> None:
    loads = loads_on(block)
    for load in loads:
        record, arrays = to_record(load)
        again = from_record(json.loads(json.dumps(record)), arrays)
        assert same(load, again)
    assert len({digest(load) for load in loads}) == 4


def test_shared_loads_are_kept_once(block: TetMesh) -> None:
    loads, of_path = distinct(paths_on(block))
    assert len(loads) == 4
    assert of_path.tolist() == [[0, 1], [2, 3], [2, -1], [-1, -1]]


def test_definitions_survive(solved: Store, block: TetMesh) -> None:
    assert solved.element == "tet4-averaged"
    assert solved.materials == MATERIALS
    for i, path in enumerate(paths_on(block)):
        again = solved.load_path(i)
        assert np.array_equal(again.nodes, path.nodes)
        assert np.array_equal(again.forces, path.forces)
        assert len(again.more) == len(path.more)
        assert all(map(same, again.more, path.more))


def test_a_store_of_no_forces_at_all(block: TetMesh, tmp_path: Path) -> None:
    paths = paths_on(block)[1:3]
    store = Store.open(make(block, tmp_path / "s", paths=paths, element="tet4").path)
    assert store.element == "tet4"
    assert [len(store.load_path(i).nodes) for i in (0, 1)] == [0, 0]


def test_answers_are_the_solver_s_and_newton_s(solved: Store, block: TetMesh) -> None:
    assert (solved.status == 0).all()
    solver = Solver(Body(block, MATERIALS, element="tet4-averaged"))
    for i, path in enumerate(paths_on(block)):
        alone = solver.solve(path).displacement
        np.testing.assert_allclose(solved.displacement(i), alone, atol=2e-4)
    assert 0 < verify(solved).largest_mm < 1e-4


def test_everything_asked_counts(block: TetMesh, tmp_path: Path) -> None:
    paths = paths_on(block)
    pressure, sag, _, push = loads_on(block)

    def first(*more: Load) -> list[LoadPath]:
        return [replace(paths[0], more=more), *paths[1:]]

    variants: list[dict[str, Any]] = [
        {},
        {"element": "tet4"},
        {"materials": {**MATERIALS, 0: Ogden((1684.0,), (-4.7,), 20_000.0)}},
        {"paths": first(pressure)},
        {"paths": first(sag, pressure)},
        {"paths": first(replace(pressure, pressure_pa=201.0), sag)},
        {"paths": first(replace(pressure, faces=pressure.faces[1:]), sag)},
        {"paths": first(pressure, replace(sag, fluid_level_mm=None))},
        {"paths": first(pressure, sag, push)},
    ]
    hashes = [
        make(block, tmp_path / str(k), **v).definition_hash
        for k, v in enumerate(variants)
    ]
    assert len(set(hashes)) == len(variants)
    with pytest.raises(InputError, match="another mesh, load, material or element"):
        Store.resume(tmp_path / "0", Body(block, MATERIALS), paths, provenance={})
    averaged = Body(block, MATERIALS, element="tet4-averaged")
    again = Store.resume(tmp_path / "0", averaged, paths, provenance={})
    assert again.definition_hash == hashes[0]


def test_networks_are_told(solved: Store) -> None:
    assert len(solved.load_case(3, 1).nodes) == 1
    message = r"load path 0 has other .*\(gravity, pressure\), and networks take nodal"
    with pytest.raises(InputError, match=message) as raised:
        solved.load_case(0, 1)
    assert "\n" not in str(raised.value)


def test_exports_lose_no_load(solved: Store, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="arrays hold nodal forces alone"):
        export_arrays(solved.path, tmp_path / "a.npz")
    with pytest.raises(InputError, match="we write element 'tet4': leave element out"):
        export_febio(solved.path, tmp_path / "a.feb", path=3)
    export_series(solved.path, tmp_path / "series", path=1)
    assert len(list((tmp_path / "series").iterdir())) == 2
    with pytest.raises(InputError, match="needs a point array 'force_n'"):
        read_series(tmp_path / "series")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"element": "hex8"}, r"element must be one of tet4, .*\(got 'hex8'\)"),
        ({"fixed": np.arange(60)}, "is fixed"),
    ],
)
def test_what_does_not_fit(
    block: TetMesh, tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        make(block, tmp_path / "s", **changes)
    assert list(tmp_path.iterdir()) == []


def test_growth_is_stored_solved_resumed_and_verified(
    block: TetMesh, tmp_path: Path
) -> None:
    upper = np.flatnonzero(block.region == 1)
    swells = [LoadPath.of(FACTORS, VolumeGrowth(upper, 1.05))]
    store = make(block, tmp_path / "s", paths=swells)
    assert not generate(store).errors
    store = Store.open(store.path)
    assert (store.status == 0).all() and np.abs(store.displacement(0)).max() > 0.05
    assert same(store.load_path(0).more[0], swells[0].more[0])
    assert verify(store).largest_mm < 1e-4
    body = Body(block, MATERIALS, block.point_set("fixed"), element="tet4-averaged")
    assert Store.resume(store.path, body, swells, provenance={}).pending().size == 0
    other = [LoadPath.of(FACTORS, VolumeGrowth(upper, 1.06))]
    with pytest.raises(InputError, match="made for another"):
        Store.resume(store.path, body, other, provenance={})
    with pytest.raises(InputError, match="growth"):
        store.load_case(0, 0)
