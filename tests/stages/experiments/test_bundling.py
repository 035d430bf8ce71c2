"""What the package carries: small, calibrated, with its card."""

import numpy as np
import pytest

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.prediction.predictor import Predictor
from physgnn.serving.scene.patch_load import spread_force
from physgnn.serving.scene.viewed import Viewed, view
from physgnn.stages.experiments.bundling import MADE_BY, MAX_BYTES, check_size


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
