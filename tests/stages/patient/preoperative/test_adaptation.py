"""From a family of patients to one never seen, through the commands' functions."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.bundled import BUNDLED_FAMILY
from physgnn.config import read_preset
from physgnn.dataset import Preset, Store
from physgnn.dataset.splits.meshes import split_meshes
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import read_record
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.mechanics.loads.sampling import traction_paths
from physgnn.mechanics.materials import NeoHookean
from physgnn.prediction import PredictionStatus, Predictor
from physgnn.prediction.error_bounds.calibration import Calibration
from physgnn.stages.datasets.simulation import simulate_mesh
from physgnn.stages.networks.training import train_run
from physgnn.stages.patient.intraoperative.prediction import predict
from physgnn.stages.patient.preoperative.adaptation import adapt, adapt_run, family_run

PRESET = Preset(
    {0: NeoHookean(3000.0, 0.4), 1: NeoHookean(7500.0, 0.4)},
    partial(traction_paths, traction_pa=400.0, n_levels=3, n_paths=3),
)
LOADS = """
[materials.brain]
youngs_modulus_pa = 3000
poissons_ratio = 0.4
[materials.tumour]
youngs_modulus_pa = 7500
poissons_ratio = 0.4
[loads]
total_force_n = 0.04
paths = 3
levels = 3
"""
CONFIG = TrainingConfig(
    model="lifted",
    options={"anchors": 2, "k_hops": 1, "width": 8, "layers": 1, "pod_modes": 0},
    max_epochs=2,
    batch_size=4,
)


def patient(stretch: float, n: int = 3) -> TetMesh:
    mesh = block_mesh(n, jitter=0.1)
    points = mesh.points * [1.0, 1.3, stretch]
    return TetMesh(points, mesh.cells, mesh.region, mesh.point_sets)


@pytest.fixture(scope="module")
def family(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run trained on three patients of four, and their datasets."""
    folder = tmp_path_factory.mktemp("family")
    paths = [folder / f"{k}.zarr" for k in range(4)]
    for path, stretch in zip(paths, (0.8, 1.7, 2.0, 2.4), strict=True):
        simulate_mesh(patient(stretch), PRESET, path)
    train_run(paths, None, CONFIG, folder / "run")
    return folder


def test_bounds_come_from_the_patients_held_out(family: Path) -> None:
    stores = [Store.open(path) for path in sorted(family.glob("*.zarr"))]
    held_out = [split for split in split_meshes(stores) if len(split.validation)]
    for file in RunFolder(family / "run").calibrations:
        calibration = Calibration.read(file)
        n = calibration.n_paths
        assert n == len(held_out) == 1
        assert calibration.coverage == pytest.approx(n / (n + 1))
        assert calibration.mean_factor > 0
    record = read_record(family / "run")
    assert len(set(record["data"]["meshes"])) == len(stores)


def test_a_new_patient_has_answers_and_bounds_at_once(
    family: Path, tmp_path: Path
) -> None:
    mesh = patient(1.5, n=4)
    made = adapt_run(family / "run", mesh, PRESET, tmp_path / "new")
    assert made.n_points == mesh.n_points
    predictor = Predictor.load(tmp_path / "new")
    store, _ = simulate_mesh(mesh, PRESET, tmp_path / "truth.zarr")
    for path, level in store.samples():
        case = store.load_case(path, level)
        prediction = predictor(case)
        truth = store.displacement(path)[level]
        error = np.linalg.norm(prediction.displacement - truth, axis=1)
        assert error.max() < 0.1 * np.linalg.norm(truth, axis=1).max()
        assert prediction.status == PredictionStatus.OK
        assert prediction.error_estimate_mm is not None
        sharper = predictor(case, estimate="physical").error_estimate_mm
        assert sharper is not None
        assert sharper.coverage == prediction.error_estimate_mm.coverage
    strong = replace(case, forces=3 * case.forces)
    quick = predictor(strong, estimate="quick")
    assert quick.status == PredictionStatus.OUTSIDE_TRAINED_RANGE
    with pytest.raises(InputError, match="holds a run already"):
        adapt_run(family / "run", mesh, PRESET, tmp_path / "new")


def test_a_network_of_one_patient_has_no_bounds_for_another(
    family: Path, tmp_path: Path
) -> None:
    train_run(family / "0.zarr", None, CONFIG, tmp_path / "own")
    made = adapt_run(tmp_path / "own", patient(1.5), PRESET, tmp_path / "new")
    assert made.coverage is None
    assert not RunFolder(tmp_path / "new").calibration.exists()


def test_a_cube_adapted_from_brains_is_not_called_ok(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a family's bounds, which hold for patients, a cube in range was ok."""
    monkeypatch.chdir(tmp_path)
    cube = block_mesh(4, side=120.0)
    write_mesh("cube.vtu", cube)
    Path("loads.toml").write_text(LOADS.replace("0.04", "2.0"))
    made = adapt(None, "cube.vtu", "run", loads="loads.toml")
    assert made.coverage is None
    assert "its overlap with an ellipsoid is 0.8" in made.unlike[0]
    loaded = cube.points[cube.point_set("loaded")]
    force = np.tile([0.0, 0.0, -2.0 / len(loaded)], (len(loaded), 1))
    load = {"points": loaded.tolist(), "forces_n": force.tolist()}
    Path("load.json").write_text(json.dumps(load))
    found = predict("run", "load.json", "quick.vtu", estimate="quick")
    assert found.status == PredictionStatus.NO_ERROR_ESTIMATE
    assert found.error_estimate_mm is None


@pytest.mark.parametrize("name", [None, "bundled-family"])
def test_the_bundled_family_serves_a_patient_on_day_one(
    name: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_mesh(tmp_path / "case.vtu", patient(1.5, n=4))
    (tmp_path / "loads.toml").write_text(LOADS)
    made = adapt(name, "case.vtu", "run", loads="loads.toml")
    assert made.coverage is None and len(made.unlike) == 2  # a box of one millilitre
    predictor = Predictor.load("run")
    preset = read_preset("loads.toml")
    store, _ = simulate_mesh(predictor.body.mesh, preset, tmp_path / "truth.zarr")
    linear = build_model("linear", store.body)
    errors = []
    for path, level in store.samples():
        case, truth = store.load_case(path, level), store.displacement(path)[level]
        found = (linear.predict(case), predictor(case).displacement)
        errors.append([np.linalg.norm(u - truth, axis=1).mean() for u in found])
    of_linear, of_family = np.mean(errors, axis=0)
    assert of_family < 0.3 * of_linear


def test_a_folder_of_the_family_s_name_is_taken_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert family_run("bundled-family") == BUNDLED_FAMILY
    (tmp_path / "bundled-family").mkdir()
    assert family_run("bundled-family") == Path("bundled-family")
    assert family_run("run") == Path("run")


def test_training_goes_on_from_the_family(family: Path, tmp_path: Path) -> None:
    run = tmp_path / "tuned"
    config = replace(CONFIG, options={}, max_epochs=1)
    tuned = train_run(family / "0.zarr", None, config, run, start=family / "run")
    assert tuned.record["config"]["options"].items() >= dict(CONFIG.options).items()
    assert len(tuned.record["data"]["meshes"]) == 4
    assert Predictor.load(run).calibration is not None


def test_several_datasets_have_one_split_only(family: Path, tmp_path: Path) -> None:
    paths = sorted(family.glob("*.zarr"))
    with pytest.raises(InputError, match="split mesh only"):
        train_run(paths, "path", CONFIG, tmp_path / "run")
