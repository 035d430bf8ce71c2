"""The solver is chosen once a store, and its answers are checked like any other's."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import febio_stand_in
from physgnn.dataset import Preset, Store, generate, verification_of
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.loads.gravity import Gravity
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.meshless.solver import MeshlessSolver
from physgnn.stages.datasets.simulation import simulate_mesh


def push(_: TetMesh, loaded: np.ndarray) -> list[LoadPath]:
    return [LoadPath(loaded[[5]], [[0, 1e-3, -4e-3]], equal_levels(2))]


PRESET = Preset({0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}, push)


def test_febio(block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    febio_stand_in.put_on_path(tmp_path / "bin", monkeypatch)
    store, did = simulate_mesh(block, PRESET, tmp_path / "f.zarr", solver="febio")
    assert (did.solved, did.errors) == (1, {})
    assert store.provenance["solver"] == "febio"
    ours, _ = simulate_mesh(block, PRESET, tmp_path / "o.zarr")
    assert np.allclose(store.displacement(0), ours.displacement(0), rtol=1e-6)
    assert 0 < verification_of(store).largest_mm < 1e-4
    with pytest.raises(InputError, match="was begun with --solver febio: go on with"):
        simulate_mesh(block, PRESET, store.path)


def test_febio_takes_gravity_but_no_fluid(
    block: TetMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    febio_stand_in.put_on_path(tmp_path / "bin", monkeypatch)

    def sagging(level: float | None) -> Preset:
        gravity = Gravity((0.0, 0.6, -0.8), 1040.0, level)
        return Preset(
            PRESET.materials, lambda *_: [LoadPath.of(equal_levels(2), gravity)]
        )

    store, did = simulate_mesh(
        block, sagging(None), tmp_path / "f.zarr", solver="febio"
    )
    assert (did.solved, did.errors) == (1, {})
    ours, _ = simulate_mesh(block, sagging(None), tmp_path / "o.zarr")
    assert np.allclose(store.displacement(0), ours.displacement(0), rtol=1e-5)
    with pytest.raises(InputError, match="gravity with a level of fluid"):
        simulate_mesh(block, sagging(5.0), tmp_path / "g.zarr", solver="febio")
    assert not (tmp_path / "g.zarr").exists()


def two_pushes(_: TetMesh, loaded: np.ndarray) -> list[LoadPath]:
    forces = ([[0, 1e-3, -4e-3]], [[0, 0, -5.0]])  # the second cannot be borne
    return [LoadPath(loaded[[5]], force, equal_levels(2)) for force in forces]


def test_mtled_resumes_and_says_where_it_stopped(
    block: TetMesh, tmp_path: Path
) -> None:
    preset = replace(PRESET, paths=two_pushes)
    mesh, paths = preset.on(block)
    body = Body(mesh, PRESET.materials, mesh.point_set("fixed"))
    begun = Store.create(
        tmp_path / "m.zarr", body, paths, provenance={"solver": "mtled"}
    )
    solution = MeshlessSolver(body).solve(paths[0])
    begun.write(0, solution)  # as a run that was killed leaves it
    store, did = simulate_mesh(block, preset, begun.path, solver="mtled")
    assert (did.solved, did.errors) == (1, {})
    assert store.provenance["solver"] == "mtled"
    assert np.allclose(store.displacement(0), solution.displacement, rtol=1e-6)
    assert store.status.tolist() == [[0, 0], [Status.INVERTED, Status.NOT_REACHED]]
    assert "an element inverted" in store.messages()[1]
    assert len(verification_of(store).samples) == 0  # not of finite elements
    again, did = simulate_mesh(block, preset, begun.path, solver="mtled")
    assert did.solved == 0
    with pytest.raises(InputError, match="was begun with --solver mtled: go on with"):
        simulate_mesh(block, preset, again.path)


@pytest.mark.parametrize(
    ("solver", "message"),
    [
        ("febio", "no program 'febio4' is on PATH"),
        ("abaqus", r"no solver 'abaqus' \(there are: physgnn, febio, mtled\)"),
    ],
)
def test_refusals_leave_no_store(
    block: TetMesh,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    solver: str,
    message: str,
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(InputError, match=message):
        simulate_mesh(block, PRESET, tmp_path / "s.zarr", solver=solver, workers=2)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("solver", "message"),
    [
        ("febio", "no program 'febio4' is on PATH"),
        ("imported", "can only be imported again"),
    ],
)
def test_no_solver_to_go_on_with(
    block: TetMesh,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    solver: str,
    message: str,
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    mesh, paths = PRESET.on(block)
    store = Store.create(
        tmp_path / "s.zarr",
        Body(mesh, PRESET.materials, mesh.point_set("fixed")),
        paths,
        provenance={"solver": solver},
    )
    with pytest.raises(InputError, match=message):
        generate(store)
