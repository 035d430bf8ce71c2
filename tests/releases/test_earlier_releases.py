"""Stores and runs that earlier releases wrote open, and answer as they did.

`make.sh` made the files, in the release's own environment.
"""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from physgnn import Solver, train
from physgnn.dataset.storage.store import Store
from physgnn.io import read_load_case, read_mesh
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.prediction import Predictor
from physgnn.versions import release

HERE = Path(__file__).parent
RELEASES = sorted(HERE.glob("*.zip"))
MODELS = ("lifted", "reduced")
FULL_NEWTON_MM = 1e-3  # what a level may differ from tight Newton by
FLOAT32_MM = 1e-4


@pytest.fixture(scope="module", params=RELEASES, ids=lambda file: file.stem)
def files(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    folder = tmp_path_factory.mktemp(request.param.stem)
    with zipfile.ZipFile(request.param) as packed:
        packed.extractall(folder)
    return folder


def test_there_is_the_last_release() -> None:
    major_minor = ".".join(release("physgnn").split(".")[:2])
    assert major_minor in [file.stem for file in RELEASES]


def test_a_store_opens_and_holds_what_is_solved_today(files: Path) -> None:
    store = Store.open(files / "loads.zarr")
    assert store.mesh.n_points == read_mesh(HERE / "case.vtu").n_points
    found = Solver(store.body).solve(store.load_path(3))
    stored = store.displacement(3)
    assert np.abs(stored).max() > 0.5
    np.testing.assert_allclose(found.displacement, stored, atol=FULL_NEWTON_MM)


def test_a_store_can_be_trained_on(files: Path, tmp_path: Path) -> None:
    train(files / "loads.zarr", tmp_path / "run", max_epochs=1)
    assert (tmp_path / "run" / "run.json").exists()


@pytest.mark.parametrize("model", MODELS)
def test_a_run_predicts_what_it_did(files: Path, model: str) -> None:
    predictor = Predictor.load(files / model, warm=False)
    case = read_load_case(HERE / "load.json", predictor.body.mesh)
    found = predictor(case)
    _, before = read_displacement(files / f"{model}.vtu")
    assert np.abs(before).max() > 1.0
    np.testing.assert_allclose(found.displacement, before, atol=FLOAT32_MM)
    assert found.status.usable
