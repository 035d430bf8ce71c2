"""A store sent out and brought back is the same; what does not fit is named."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import febio_stand_in
from physgnn.dataset import Store, generate, split_path
from physgnn.dataset.exchange.exporting import (
    export_arrays,
    export_febio,
    export_series,
)
from physgnn.dataset.exchange.importing import import_results
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.febio.model_reader import read_febio
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.loads.pressure import SurfacePressure, faces_within
from physgnn.mechanics.materials import NeoHookean

NewStore = Callable[..., Store]


@pytest.fixture
def solved(new_store: NewStore) -> Store:
    store = new_store(n_paths=3)
    generate(store)
    return store


def assert_same(imported: Store, store: Store) -> None:
    assert imported.mesh.content_hash == store.mesh.content_hash
    assert imported.materials == store.materials
    assert np.array_equal(imported.load_factors, store.load_factors)
    assert np.array_equal(imported.status, store.status)
    assert np.array_equal(imported.fixed, store.fixed)
    for i in range(store.n_paths):
        ours, theirs = store.load_path(i), imported.load_path(i)
        assert np.array_equal(theirs.nodes, ours.nodes)
        assert np.allclose(theirs.forces, ours.forces, rtol=1e-15)
        assert np.array_equal(imported.displacement(i), store.displacement(i))
    assert imported.pending().tolist() == []


def test_arrays(solved: Store, tmp_path: Path) -> None:
    export_arrays(solved.path, tmp_path / "a.npz")
    told: list[tuple[int, int, str]] = []
    imported = import_results(
        [tmp_path / "a.npz"],
        tmp_path / "b.zarr",
        materials=solved.materials,
        progress=lambda *step: told.append(step),
    )
    assert_same(imported, solved)
    assert imported.content_hash() == solved.content_hash()
    assert imported.provenance["imported_from"] == [str(tmp_path / "a.npz")]
    assert [step[:2] for step in told] == [(1, 3), (2, 3), (3, 3)]


def test_series(solved: Store, tmp_path: Path) -> None:
    folders = [tmp_path / f"path-{i}" for i in range(3)]
    for i, folder in enumerate(folders):
        export_series(solved.path, folder, path=i)
    imported = import_results(folders, tmp_path / "b.zarr", materials=solved.materials)
    assert_same(imported, solved)


def test_febio(solved: Store, tmp_path: Path) -> None:
    models = [tmp_path / f"path-{i}.feb" for i in range(3)]
    for i, file in enumerate(models):
        export_febio(solved.path, file, path=i)
        run_stand_in(file)
    imported = import_results(models, tmp_path / "b.zarr")
    assert imported.materials == solved.materials
    assert np.array_equal(imported.status, solved.status)
    for i in range(3):
        theirs, ours = imported.displacement(i), solved.displacement(i)
        assert np.allclose(theirs, ours, rtol=1e-6, atol=1e-9)
    assert len(split_path(imported).train) == 3


def run_stand_in(file: Path) -> None:
    model = read_febio(file)
    solver = Solver(Body(model.mesh, model.materials, model.fixed))
    assert model.log is not None
    febio_stand_in.write_log(model.log, model, solver.solve(model.load_path))


def test_a_path_that_ends_early_keeps_its_levels(solved: Store, tmp_path: Path) -> None:
    folders = [tmp_path / f"path-{i}" for i in range(2)]
    for i, folder in enumerate(folders):
        export_series(solved.path, folder, path=i)
    (folders[0] / "level-0002.vtu").unlink()
    imported = import_results(folders, tmp_path / "b.zarr", materials=solved.materials)
    assert imported.status.tolist() == [[0, 0, 3], [0, 0, 0]]
    assert imported.message(0) == "stopped at load factor 0.6667"
    assert not imported.displacement(0)[2].any()


def test_what_does_not_fit_leaves_no_store(
    solved: Store, new_store: NewStore, tmp_path: Path
) -> None:
    export_series(solved.path, tmp_path / "whole", path=0)
    other = new_store("other", n_paths=1)
    export_febio(other.path, tmp_path / "a.feb")
    (tmp_path / "few.feb").write_text(without_log(tmp_path / "a.feb"))
    export_arrays(solved.path, tmp_path / "a.npz")
    arrays = dict(np.load(tmp_path / "a.npz"))
    arrays["fixed"] = arrays["fixed"][1:]
    np.savez(tmp_path / "held.npz", **arrays)
    arrays["load_nodes"][0, 0] = arrays["fixed"][0]
    np.savez(tmp_path / "pushed.npz", **arrays)
    for sources, message in (
        (["a.txt"], "expected .feb, .npz, a folder of .vtu files (got '.txt')"),
        (["no.npz"], "no.npz: no such file"),
        (["a.feb"], "a-displacement.log: cannot be read, there is no such file"),
        (["few.feb"], 'needs <node_data data="ux;uy;uz"'),
        (["whole", "held.npz"], "held.npz, load path 0: holds other points than"),
        (["whole", "a.feb"], "a.feb: has other materials than"),
        (["pushed.npz"], "pushed.npz, load path 0: loaded node"),
    ):
        with pytest.raises(InputError) as error:
            import_results([tmp_path / s for s in sources], tmp_path / "b.zarr")
        assert message in str(error.value)
        assert "\n" not in str(error.value)
        assert not list(tmp_path.glob("*b.zarr*"))
    with pytest.raises(InputError, match="exists already: name another store"):
        import_results([tmp_path / "a.npz"], solved.path)


def without_log(model: Path) -> str:
    text = model.read_text()
    start, end = text.index("<node_data"), text.index("</logfile>")
    return text[:start] + text[end:]


def test_another_mesh(solved: Store, tmp_path: Path) -> None:
    export_arrays(solved.path, tmp_path / "a.npz")
    arrays = dict(np.load(tmp_path / "a.npz"))
    arrays["points"] = arrays["points"] * 1.1
    np.savez(tmp_path / "b.npz", **arrays)
    with pytest.raises(InputError, match="load path 0: has another mesh than"):
        import_results([tmp_path / "a.npz", tmp_path / "b.npz"], tmp_path / "b.zarr")


def test_no_such_path(solved: Store, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"load path must be in 0…2 \(got 3\)"):
        export_febio(solved.path, tmp_path / "a.feb", path=3)
    with pytest.raises(InputError, match="a mesh needs --preset or --loads"):
        export_febio(solved.path, tmp_path / "a.feb", preset="paper-1")


def test_the_element_is_recorded(solved: Store, tmp_path: Path) -> None:
    export_arrays(solved.path, tmp_path / "a.npz")
    imported = import_results(
        [tmp_path / "a.npz"], tmp_path / "b.zarr", element="tet4-averaged"
    )
    assert imported.element == "tet4-averaged"
    with pytest.raises(InputError, match="element"):
        import_results([tmp_path / "a.npz"], tmp_path / "c.zarr", element="hex8")
    assert not (tmp_path / "c.zarr").exists()


def test_febio_with_loads_that_are_no_forces(block: TetMesh, tmp_path: Path) -> None:
    """Out of a dataset, solved, and into another: the same loads and displacement."""
    top = block.point_set("loaded")
    path = LoadPath.of(
        np.array([0.5, 1.0]),
        Gravity((0.0, 0.6, -0.8), 1040.0),
        SurfacePressure(faces_within(block, top[:12]), 100.0),
        PrescribedDisplacement(
            top[-2:], np.array([[0.1, 0.0, -0.2], [0.1, 0.1, -0.2]])
        ),
    )
    materials = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
    made = Store.create(
        tmp_path / "a.zarr",
        Body(block, materials, block.point_set("fixed")),
        [path],
        provenance={},
    )
    generate(made)
    export_febio(made.path, tmp_path / "a.feb")
    run_stand_in(tmp_path / "a.feb")
    imported = import_results([tmp_path / "a.feb"], tmp_path / "b.zarr")
    kinds = [type(load) for load in imported.load_path(0).more]
    assert kinds == [Gravity, SurfacePressure, PrescribedDisplacement]
    theirs, ours = imported.displacement(0), made.displacement(0)
    assert np.abs(ours).max() > 0.2
    assert np.allclose(theirs, ours, rtol=1e-5, atol=1e-7)


def changed(solved: Store, tmp_path: Path, **arrays: object) -> Path:
    """Export a store as arrays, some of them others."""
    export_arrays(solved.path, tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        np.savez(tmp_path / "b.npz", **{**file, **arrays})
    return tmp_path / "b.npz"


def test_fixed_points_that_move(solved: Store, tmp_path: Path) -> None:
    """Positions in place of displacements, and a rigid motion on top of them."""
    found = np.stack([solved.displacement(i) for i in range(3)]).astype(np.float64)
    for wrong in (found + solved.mesh.points, found + 0.02):
        source = changed(solved, tmp_path, displacement=wrong)
        with pytest.raises(InputError, match="fixed points must not move"):
            import_results([source], tmp_path / "c.zarr", materials=solved.materials)
    assert sorted(p.name for p in tmp_path.glob("*c.zarr*")) == []
    source = changed(solved, tmp_path, displacement=found + 0.005)
    import_results([source], tmp_path / "c.zarr", materials=solved.materials)


def test_a_mesh_in_metres(solved: Store, tmp_path: Path) -> None:
    source = changed(solved, tmp_path, points=solved.mesh.points / 1000.0)
    with pytest.raises(InputError, match=r"must be in mm .*looks like metres"):
        import_results([source], tmp_path / "c.zarr", materials=solved.materials)


@pytest.mark.parametrize("name", ["cells", "fixed", "load_nodes", "region"])
def test_arrays_of_indices_that_are_none(
    solved: Store, tmp_path: Path, name: str
) -> None:
    export_arrays(solved.path, tmp_path / "a.npz")
    good = np.load(tmp_path / "a.npz")[name]
    for wrong in (good + 0.5, good + np.int64(2**32), np.where(good > 0, np.nan, good)):
        source = changed(solved, tmp_path, **{name: wrong})
        with pytest.raises(InputError, match=name):
            import_results([source], tmp_path / "c.zarr", materials=solved.materials)


@pytest.mark.parametrize("name", ["points", "displacement", "load_vectors"])
def test_complex_numbers(solved: Store, tmp_path: Path, name: str) -> None:
    export_arrays(solved.path, tmp_path / "a.npz")
    wrong = np.load(tmp_path / "a.npz")[name] + 1j
    source = changed(solved, tmp_path, **{name: wrong})
    with pytest.raises(InputError, match=name):
        import_results([source], tmp_path / "c.zarr", materials=solved.materials)


def test_a_point_that_no_cell_uses(solved: Store, tmp_path: Path) -> None:
    found = np.stack([solved.displacement(i) for i in range(3)]).astype(np.float64)
    source = changed(
        solved,
        tmp_path,
        points=np.vstack([solved.mesh.points, [[9.0, 9.0, 99.0]]]),
        displacement=np.concatenate([found, np.zeros((*found.shape[:2], 1, 3))], 2),
    )
    with pytest.raises(InputError, match="every point must belong to a cell"):
        import_results([source], tmp_path / "c.zarr", materials=solved.materials)
