"""Calibrated bounds cover errors, and survive being written down."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.baselines.linear import Linear
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.error_bounds.calibration import Calibration, calibrate
from physgnn.prediction.error_bounds.indicators import INDICATORS
from physgnn.prediction.predictor import Predictor


@pytest.fixture(scope="module")
def calibration(store: Store, body: Body, parts: tuple) -> Calibration:
    linear = Linear(body)
    indicator = ("displacement", INDICATORS["displacement"](linear))
    return calibrate(linear, indicator, store, parts[:2])


def test_bounds_cover_what_they_were_calibrated_on(
    store: Store, body: Body, parts: tuple, calibration: Calibration
) -> None:
    """Four paths cannot promise 90 %, so the bound is the largest score seen."""
    assert calibration.coverage == pytest.approx(4 / 5)
    assert (calibration.n_paths, calibration.n_samples) == (4, 12)
    answer = Linear(body).predict
    indicator = INDICATORS["displacement"](Linear(body))
    for path, level in parts[1]:
        case = store.load_case(path, level)
        predicted = answer(case)
        error = np.linalg.norm(store.displacement(path)[level] - predicted, axis=1)
        estimate = calibration.estimate(indicator(case, predicted))
        assert error.mean() <= estimate.mean_mm * (1 + 1e-9)
        assert error.max() <= estimate.max_mm * (1 + 1e-9)


def test_correction_indicates_nothing_for_the_linear_solution(
    store: Store, body: Body
) -> None:
    case = store.load_case(0, 2)
    linear = Linear(body)
    correction = INDICATORS["correction"](linear)(case, linear.predict(case))
    assert np.abs(correction).max() < 1e-9


def test_residual_indicates_the_error(store: Store, body: Body) -> None:
    """Nothing where there is none; all of it near rest; finite with inverted cells."""
    case, truth = store.load_case(0, 0), store.displacement(0)[0]
    residual = INDICATORS["residual"](Linear(body))
    assert np.abs(residual(case, truth.astype(float))).max() < 1e-4
    # about the rest state K₀ is the tangent, and the residual the error
    slight = LoadCase(case.nodes, 1e-4 * case.forces)
    answer = Linear(body).predict(slight)
    indicated = residual(slight, 1.1 * answer)
    np.testing.assert_allclose(
        indicated, -0.1 * answer, atol=1e-3 * np.abs(answer).max()
    )
    assert np.isfinite(residual(case, -100.0 * truth)).all()


def test_json_round_trip(calibration: Calibration, tmp_path: Path) -> None:
    calibration.write(tmp_path / "calibration.json")
    assert Calibration.read(tmp_path / "calibration.json") == calibration
    assert [p.name for p in tmp_path.iterdir()] == ["calibration.json"]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"trained_range": {}}'])
def test_another_file_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "calibration.json").write_text(text)
    with pytest.raises(InputError, match="is not a calibration"):
        Calibration.read(tmp_path / "calibration.json")


def test_calibration_needs_samples(store: Store, body: Body, parts: tuple) -> None:
    nothing = np.empty((0, 2), dtype=np.int64)
    indicator = ("displacement", INDICATORS["displacement"](Linear(body)))
    with pytest.raises(InputError, match="validation samples"):
        calibrate(Linear(body), indicator, store, (parts[0], nothing))


def test_other_promises_have_other_factors(calibration: Calibration) -> None:
    """Four paths cannot promise more than 4 / 5, and say so."""
    assert [row[0] for row in calibration.others] == [pytest.approx(4 / 5)]
    same = calibration.at(calibration.coverage)
    assert same == calibration
    with pytest.raises(InputError, match=r"calibrated for coverage 0\.99"):
        calibration.at(0.99)


def test_a_higher_promise_has_no_smaller_factor(
    store: Store, body: Body, parts: tuple
) -> None:
    answer = Linear(body)
    indicator = ("displacement", INDICATORS["displacement"](answer))
    found = calibrate(answer, indicator, store, parts[:2], coverages=(0.5, 0.75))
    stricter = found.at(0.75)
    assert stricter.coverage == 0.75
    assert stricter.max_factor >= found.max_factor
    assert stricter.mean_factor >= found.mean_factor


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("max_factor", float("nan")),
        ("mean_factor", -1.0),
        ("coverage", 1.5),
        ("max_factor", "much"),
        ("others", [[0.95, float("inf"), 1.0]]),
    ],
)
def test_numbers_that_promise_nothing_are_refused(
    calibration: Calibration, tmp_path: Path, key: str, value: object
) -> None:
    file = tmp_path / "calibration.json"
    calibration.write(file)
    file.write_text(json.dumps({**json.loads(file.read_text()), key: value}))
    with pytest.raises(InputError, match="calibrate the run again"):
        Calibration.read(file)


def test_a_range_without_end_is_refused(
    calibration: Calibration, tmp_path: Path
) -> None:
    file = tmp_path / "calibration.json"
    calibration.write(file)
    record = json.loads(file.read_text())
    record["trained_range"]["total_force_n"] = float("nan")
    file.write_text(json.dumps(record))
    with pytest.raises(InputError, match="trained range must be finite"):
        Calibration.read(file)


def test_an_unknown_indicator_is_refused(body: Body, calibration: Calibration) -> None:
    odd = replace(calibration, indicator="guess")
    with pytest.raises(InputError, match="indicator must be one of displacement"):
        Predictor(Linear(body), calibration=odd)
