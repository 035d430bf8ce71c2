"""What the package carries: small, calibrated, with its card."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.bundled import BUNDLED_FAMILY, BUNDLED_RUN
from physgnn.dataset import PRESETS, Preset
from physgnn.errors import InputError
from physgnn.evaluation import run_evaluation
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.learning.runs.checkpoint import read_record
from physgnn.mechanics.loads.sampling import traction_paths
from physgnn.mechanics.materials import NeoHookean
from physgnn.prediction.predictor import Predictor
from physgnn.serving.scene.patch_load import spread_force
from physgnn.serving.scene.viewed import Viewed, view
from physgnn.stages.experiments import family_bundling
from physgnn.stages.experiments.family_bundling import FamilyRecipe, bundle_family
from physgnn.stages.experiments.packaged_run import MADE_BY, MAX_BYTES, check_size

PRESET = Preset(
    {0: NeoHookean(3000.0, 0.4), 1: NeoHookean(7500.0, 0.4)},
    partial(traction_paths, traction_pa=400.0, n_levels=3, n_paths=3),
)


@pytest.fixture(scope="module")
def bundled() -> Viewed:
    return view(None)


def test_a_model_too_large_for_the_package_is_refused(tmp_path) -> None:
    (tmp_path / "weights.safetensors").write_bytes(bytes(MAX_BYTES + 1))
    with pytest.raises(InputError, match="at most"):
        check_size(tmp_path)


def test_the_package_carries_a_calibrated_model(bundled: Viewed) -> None:
    check_size(BUNDLED_RUN)
    kinds = {path.suffix for path in BUNDLED_RUN.iterdir()}
    assert kinds == {".json", ".md", ".safetensors", ".vtu"}
    card = (BUNDLED_RUN / "model_card.md").read_text("utf-8")
    assert "Error of every predictor" in card
    assert f"`{MADE_BY}`" in card
    predictor = Predictor.load(BUNDLED_RUN, warm=False)
    assert predictor.calibration is not None
    assert predictor.relaxation is not None
    trained = predictor.calibration.trained_range.nodes
    assert set(trained) == set(bundled.exposed.nodes)


def test_the_package_carries_a_family_and_says_how_good_it_is() -> None:
    check_size(BUNDLED_FAMILY)
    record = read_record(BUNDLED_FAMILY)
    assert len(set(record["data"]["meshes"])) == FamilyRecipe().patients
    assert record["config"]["options"]["pod_modes"] == 0
    card = (BUNDLED_FAMILY / "model_card.md").read_text("utf-8")
    assert "Patients never seen" in card
    assert "`physgnn adapt` makes it ready for another" in card
    rows = [line.split("|") for line in card.splitlines() if line.startswith("| mean")]
    assert len(rows) == 1
    linear, family = float(rows[0][3]), float(rows[0][5])
    assert family < 0.2 * linear


@pytest.mark.parametrize("radius_mm", [5.0, 12.0, 20.0, 30.0, 45.0])
def test_patches_of_every_size_are_within_its_range(
    bundled: Viewed, radius_mm: float
) -> None:
    exposed = bundled.exposed
    centre = exposed.points.mean(axis=0)
    middle = np.linalg.norm(exposed.points - centre, axis=1).argmin()
    point, inward = exposed.points[middle], -exposed.normals[middle]
    share = np.linalg.norm(
        spread_force(exposed, point, inward, radius_mm).forces, axis=1
    )
    force = min(3.0, 0.25 / share.max())  # no node more than 0.25 N
    gentle = spread_force(exposed, point, force * inward, radius_mm)
    calibration = Predictor.load(BUNDLED_RUN, warm=False).calibration
    assert calibration is not None
    loads = calibration.trained_range
    assert loads.reasons_outside(gentle) == []
    strong = spread_force(exposed, point, 2 * force * inward, radius_mm)
    assert loads.reasons_outside(strong)


@pytest.mark.slow
def test_a_family_is_made_and_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Anatomies, datasets, run and card, of blocks instead of brains."""
    monkeypatch.setattr(family_bundling, "anatomies", blocks)
    monkeypatch.setitem(PRESETS, "family", PRESET)
    monkeypatch.setattr(family_bundling, "processes", lambda: 1)
    for drawing in ("draw_figures", "draw_bars"):  # of a brain
        monkeypatch.setattr(run_evaluation, drawing, lambda *_: ())
    monkeypatch.setattr(
        run_evaluation, "write_report", lambda *told: told[-1].write_text("a page")
    )
    small = {"anchors": 2, "k_hops": 1, "width": 8, "layers": 1, "pod_modes": 0}
    settings = {**family_bundling.SETTINGS, "options": small, "max_epochs": 1}
    monkeypatch.setattr(family_bundling, "SETTINGS", settings)
    recipe = FamilyRecipe(patients=3, unseen=2, minutes=1.0)
    made = bundle_family(tmp_path / "work", tmp_path / "out", recipe=recipe)
    kinds = {path.suffix for path in made.iterdir()}
    assert kinds == {".json", ".md", ".safetensors", ".vtu"}
    card = (made / "model_card.md").read_text("utf-8")
    assert card.count("| block-") == recipe.unseen
    assert str(tmp_path) not in (made / "run.json").read_text("utf-8")
    said: list[str] = []
    bundle_family(tmp_path / "work", tmp_path / "again", recipe=recipe, log=said.append)
    assert said == [f"{tmp_path / 'work' / 'run'}: there already"]


def blocks(folder: Path, *, count: int, **_: object) -> list[Path]:
    """Write blocks of different heights."""
    folder.mkdir(parents=True, exist_ok=True)
    made = [folder / f"block-{i}.vtu" for i in range(count)]
    for i, path in enumerate(made):
        mesh = block_mesh(3, jitter=0.1)
        points = mesh.points * [1.0, 1.3, 0.8 + 0.3 * i]
        write_mesh(path, TetMesh(points, mesh.cells, mesh.region, mesh.point_sets))
    return made
