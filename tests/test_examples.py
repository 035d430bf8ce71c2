"""What examples/ shows works."""

import runpy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from physgnn.config import read_preset, read_training
from physgnn.dataset import PRESETS, Store, verification_of
from physgnn.geometry import Surface, TetMesh, tetrahedralize
from physgnn.stages.datasets.simulation import simulate_mesh

EXAMPLES = Path(__file__).parents[1] / "examples"
# Without forces the one path has the loads of [[loads.more]] alone.
BEYOND_FORCES = ("sagging", "retraction", "resection", "displacement", "swelling")
# The number that each example is about.
HEADLINES: dict[str, Callable[[dict[str, float]], bool]] = {
    "01_solve_one_load": lambda of: 15 < of["largest_mm"] < 0.9 * of["linear_mm"],
    "02_a_law_of_your_own": lambda of: (
        of["derivative_error"] < 1e-7 and 1.5 < of["stiffer_at_0.7"] < 1.6
    ),
    "03_mesh_from_labels": lambda of: (
        4500 < of["points"] < 5500
        and all(abs(v) < 0.5 for k, v in of.items() if k.endswith("_percent"))
    ),
    "04_train_and_predict": lambda of: of["network_mm"] < 0.2 * of["linear_mm"],
    "05_adapt_to_a_patient": lambda of: (
        of["adapted network"] < 0.25 * of["linear solution"]
    ),
    "06_register_and_warp": lambda of: of["error_mm"] < 0.25 * of["doing_nothing_mm"],
    "07_a_method_of_your_own": lambda of: (
        of["linear"] < of["method:NearestLoad"] < 0.5 * of["zero"]
    ),
}


def sphere(radius: float, centre: tuple[float, float, float], nsub: int) -> Surface:
    made = pv.Icosphere(radius=radius, center=centre, nsub=nsub)
    return Surface(made.points, made.regular_faces.astype(np.int32))


@pytest.fixture(scope="module")
def ball() -> TetMesh:
    """A ball about as large as the bundled brain, with a tumour in the same place."""
    brain, tumour = sphere(75.0, (0, 0, 0), 3), sphere(11.0, (30, 15, 42), 1)
    return tetrahedralize(brain, [tumour], max_volume_mm3=1e4)


def test_every_example_is_tested() -> None:
    names = {path.name for path in EXAMPLES.iterdir() if path.is_file()}
    assert names == {
        "craniotomy.toml",
        "training.toml",
        "simulate_block.py",
        "measured.csv",
        "scan_to_scan.ipynb",  # tests/test_notebook.py
        *(f"{name}.toml" for name in BEYOND_FORCES),
        *(f"{name}.py" for name in HEADLINES),
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", HEADLINES)
def test_headline(name: str, tmp_path: Path) -> None:
    found = runpy.run_path(str(EXAMPLES / f"{name}.py"))["main"](tmp_path)
    assert HEADLINES[name](found), found
    assert (tmp_path / "picture.png").stat().st_size > 5000
    page = (EXAMPLES.parent / "docs" / "examples.md").read_text("utf-8")
    assert f'--8<-- "examples/{name}.py"' in page  # it is in the gallery


@pytest.mark.parametrize("name", BEYOND_FORCES)
def test_more_than_forces(name: str, ball: TetMesh, tmp_path: Path) -> None:
    preset = read_preset(EXAMPLES / f"{name}.toml")
    store, did = simulate_mesh(ball, preset, tmp_path / "s.zarr")
    assert not did.errors
    assert (store.status == 0).all()
    assert verification_of(store).largest_mm < 1e-4
    store = Store.open(store.path)
    assert store.element == preset.element
    assert all(store.load_path(i).more for i in range(store.n_paths))
    largest = np.linalg.norm(store.displacement(0)[-1], axis=1).max()
    assert 0.5 < largest < 15
    assert (store.mesh.n_cells < ball.n_cells) == (name == "resection")


def test_simulate_block(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example = runpy.run_path(str(EXAMPLES / "simulate_block.py"))
    example["main"](tmp_path / "block.zarr")
    printed = capsys.readouterr().out
    assert "30 samples, largest displacement" in printed
    assert "20 train, 5 test" in printed


def test_craniotomy_loads_the_body_of_the_demonstration() -> None:
    ours, demo = read_preset(EXAMPLES / "craniotomy.toml"), PRESETS["demo"]
    assert (ours.fixed, ours.loaded) == (demo.fixed, demo.loaded)
    assert ours.materials == demo.materials


def test_training() -> None:
    config = read_training(EXAMPLES / "training.toml")
    assert config.options == {"configuration": 3, "dataset": 2}
    assert (config.batch_size, config.schedule) == (8, "plateau")
