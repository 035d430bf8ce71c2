"""The table of scalars to colour by, and a row of one's own."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import Prediction, PredictionStatus
from physgnn.serving.protocol.frames import decode
from physgnn.serving.protocol.messages import read_patch_load
from physgnn.serving.scene.colours import FIELDS, SolvedLoad
from physgnn.serving.scene.viewed import Viewed
from physgnn.serving.sessions.engine import Engine
from physgnn.serving.sessions.predictions import prediction_frame, scene_frame

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "add_colour.md"
PATCH_LOAD = {
    "type": "patch_load",
    "point": [5, 5, 10],
    "force_n": [0, 0, -0.01],
    "radius_mm": 6,
    "predictors": ["linear"],
}


@pytest.fixture
def case(viewed: Viewed) -> LoadCase:
    return LoadCase(viewed.exposed.nodes[:4], np.tile([0, 0, -1e-3], (4, 1)))


def solved(by: str, case: LoadCase, displacement: np.ndarray) -> SolvedLoad:
    prediction = Prediction(displacement, None, PredictionStatus.OK, 0.0)
    return SolvedLoad(by, case, prediction)


def measured(name: str, viewed: Viewed, load: SolvedLoad) -> np.ndarray | None:
    measure = FIELDS[name].measure
    assert measure is not None
    return measure(viewed, load)


@pytest.fixture
def own_row() -> None:
    """The template of the documentation, run."""
    rows = dict(FIELDS)
    template = re.search(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert template is not None
    exec(template[1], {})
    yield
    FIELDS.clear()
    FIELDS.update(rows)


def test_volume_ratio_is_det_f(viewed: Viewed, case: LoadCase) -> None:
    F = np.array([[1.1, 0.2, 0], [0, 0.9, 0.1], [0.3, 0, 1.05]])
    stretched = viewed.body.mesh.points @ (F - np.eye(3)).T
    ratio = measured("volume", viewed, solved("linear", case, stretched))
    np.testing.assert_allclose(ratio, np.linalg.det(F))


def test_the_error_field_peaks_at_the_bound(viewed: Viewed, case: LoadCase) -> None:
    prediction = viewed.predictors["network"](case)
    field = measured("error", viewed, SolvedLoad("network", case, prediction))
    assert prediction.error_estimate_mm is not None
    floor = 0.01 * viewed.calibration.max_factor  # calibration.FLOOR_MM
    assert field.max() + floor == pytest.approx(prediction.error_estimate_mm.max_mm)


def test_linear_elasticity_has_no_error_field(viewed: Viewed, case: LoadCase) -> None:
    zero = np.zeros_like(viewed.body.mesh.points)
    assert measured("error", viewed, solved("linear", case, zero)) is None


def test_the_first_frame_tells_the_page_every_row(engine: Engine) -> None:
    header, _ = decode(scene_frame(engine))
    without_desk = [name for name, row in FIELDS.items() if not row.registered]
    assert list(header["fields"]) == without_desk
    for name, row in header["fields"].items():
        assert (row["label"], row["title"]) == (FIELDS[name].label, FIELDS[name].title)
        assert all(re.fullmatch("#[0-9a-f]{6}", colour) for colour in row["stops"])
        assert row["least"] > 0


def test_without_a_calibration_the_page_cannot_choose_the_error(
    viewed: Viewed,
) -> None:
    bare = Viewed(viewed.title, viewed.body, viewed.predictors, viewed.exposed)
    assert FIELDS["error"].describe(viewed)["available"]
    assert not FIELDS["error"].describe(bare)["available"]
    assert FIELDS["volume"].describe(bare)["available"]


@pytest.mark.usefixtures("own_row")
def test_a_row_of_ones_own_is_told_accepted_and_answered(engine: Engine) -> None:
    header, _ = decode(scene_frame(engine))
    assert header["fields"]["upward"]["label"] == "Upward"
    patch_load = read_patch_load(json.dumps({**PATCH_LOAD, "field": "upward"}))
    nodes = engine.viewed.exposed.nodes
    up = np.linspace(0.0, 1.0, engine.viewed.body.mesh.n_points)
    moved = np.column_stack([0 * up, 0 * up, up])
    load = solved("linear", LoadCase(nodes[:1], np.ones((1, 3))), moved)
    _, arrays = decode(prediction_frame(engine, patch_load, load, None))
    np.testing.assert_allclose(arrays["field"], up[engine.shown.nodes], rtol=1e-6)


def test_no_label_is_typed_again_on_the_page() -> None:
    static = Path(__file__).parents[3] / "src/physgnn/serving/static"
    files = [f for f in static.rglob("*.[jh]*") if "vendor" not in f.parts]
    page = "".join(file.read_text("utf-8") for file in files)
    for name, row in FIELDS.items():
        assert f'"{row.title}"' not in page, name
