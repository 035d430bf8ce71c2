"""What the package carries: small, calibrated, with its card."""

import pytest

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.prediction.predictor import Predictor
from physgnn.serving.viewed import view
from physgnn.stages.bundling import MAX_BYTES, check_size


def test_a_model_too_large_for_the_package_is_refused(tmp_path) -> None:
    (tmp_path / "weights.safetensors").write_bytes(bytes(MAX_BYTES + 1))
    with pytest.raises(InputError, match="at most"):
        check_size(tmp_path)


def test_the_package_carries_a_calibrated_model() -> None:
    check_size(BUNDLED_RUN)
    kinds = {path.suffix for path in BUNDLED_RUN.iterdir()}
    assert kinds == {".json", ".md", ".safetensors", ".vtu"}
    card = (BUNDLED_RUN / "model_card.md").read_text("utf-8")
    assert "Error of every predictor" in card
    predictor = Predictor.load(BUNDLED_RUN)
    assert predictor.calibration is not None
    exposed = view(None).exposed
    assert set(predictor.calibration.trained_range.nodes) == set(exposed.nodes)
