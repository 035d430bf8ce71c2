"""A predictor says how far to trust it, and is repaired where that is not enough."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from physgnn.bundled import BUNDLED_RUN
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.io.vtk.prediction_file import USABLE
from physgnn.learning.baselines.linear import Linear
from physgnn.learning.graph import graph_of
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.surrogate import FromFunction
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.error_bounds.calibration import RELAXATION, calibrate
from physgnn.prediction.error_bounds.indicators import INDICATORS
from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.prediction import PredictionStatus
from physgnn.prediction.predictor import (
    Predictor,
)
from physgnn.prediction.repair_policy import UNSURE_BY

SOLVER_MM = 1e-3  # two solves of one case agree at least this well


@pytest.fixture(scope="module")
def predictor(store: Store, body: Body, parts: tuple) -> Predictor:
    linear = Linear(body)
    indicator = ("displacement", INDICATORS["displacement"](linear))
    calibration = calibrate(linear, indicator, store, parts[:2])
    return Predictor(linear, calibration=calibration)


def test_carries_its_estimate(store: Store, predictor: Predictor, parts: tuple) -> None:
    held = []
    for path, level in parts[2]:
        prediction = predictor(store.load_case(path, level))
        truth = store.displacement(path)[level]
        error = np.linalg.norm(truth - prediction.displacement, axis=1).max()
        assert prediction.error_estimate_mm is not None
        held.append(error <= prediction.error_estimate_mm.max_mm)
        assert prediction.seconds > 0
    assert np.mean(held) >= 0.6  # promised 0.8 on average, on 4 paths of 3 levels


def test_tolerance_is_met(store: Store, predictor: Predictor, parts: tuple) -> None:
    """Above the tolerance the answer is repaired; below it it stands."""
    path, level = parts[2][-1]
    case = store.load_case(path, level)
    cheap = predictor(case)
    assert cheap.error_estimate_mm is not None
    estimate = cheap.error_estimate_mm.max_mm
    same = predictor(case, tolerance_mm=1.01 * estimate)
    np.testing.assert_array_equal(same.displacement, cheap.displacement)
    assert same.status is PredictionStatus.OK
    solved = predictor(case, tolerance_mm=0.5 * estimate)
    assert solved.status is PredictionStatus.REPAIRED
    assert solved.error_estimate_mm is not None
    assert solved.error_estimate_mm.max_mm <= 0.5 * estimate
    truth = store.displacement(path)[level]
    error = np.linalg.norm(solved.displacement - truth, axis=1).max()
    assert error <= solved.error_estimate_mm.max_mm + SOLVER_MM


def test_outside_the_trained_range(store: Store, predictor: Predictor) -> None:
    """A pull where training pushed is flagged, and solved if a tolerance is given."""
    case = store.load_case(0, 1)
    pull = LoadCase(case.nodes, -case.forces)
    assert predictor(pull).status is PredictionStatus.OUTSIDE_TRAINED_RANGE
    solved = predictor(pull, tolerance_mm=1e-2)
    assert solved.status is PredictionStatus.REPAIRED
    exact = FiniteElementPredictor(predictor.body)(pull).displacement
    assert np.linalg.norm(solved.displacement - exact, axis=1).max() < 1e-2


def test_a_useless_displacement_is_solved_from_rest(store: Store, body: Body) -> None:
    """Whatever the network says, a tolerance is met or the status says it is not."""
    case, truth = store.load_case(0, 2), store.displacement(0)[2]
    lost = Predictor(FromFunction(body, lambda _: np.full(truth.shape, np.nan)))
    prediction = lost(case, tolerance_mm=0.01)
    assert prediction.status is PredictionStatus.SOLVED
    assert np.linalg.norm(prediction.displacement - truth, axis=1).max() < 0.01


def test_a_displacement_its_maker_does_not_trust_is_no_start_of_a_repair(
    store: Store, body: Body
) -> None:
    case, truth = store.load_case(0, 2), store.displacement(0)[2]
    near = truth + 1e-3 * np.sin(body.mesh.points) * (truth != 0)
    for sound, status in ((True, "REPAIRED"), (False, "SOLVED")):
        surrogate = FromFunction(body, lambda _: near)
        surrogate.is_sound = lambda _, s=sound: s  # type: ignore[method-assign]
        predictor = Predictor(surrogate)
        prediction = predictor(case, tolerance_mm=0.01)
        assert prediction.status.name == status
        assert np.linalg.norm(prediction.displacement - truth, axis=1).max() < 0.01


def test_the_estimate_is_larger_where_a_displacement_does_not_tell_its_equilibrium(
    body: Body, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = LoadCase(body.mesh.point_set("loaded")[:1], np.array([[0.0, 0.0, -0.01]]))
    predictor = Predictor(Linear(body))
    shallow = predictor(case, estimate="physical").likely_error_mm
    monkeypatch.setattr("physgnn.prediction.repair_policy.UNSURE_FROM", 1e-6)
    deep = predictor(case, estimate="physical").likely_error_mm
    assert shallow is not None
    assert deep is not None
    assert deep.mean_mm == pytest.approx(UNSURE_BY * shallow.mean_mm)
    assert deep.max_mm == pytest.approx(UNSURE_BY * shallow.max_mm)


def test_never_a_good_status_for_a_load_that_cannot_be_solved(
    store: Store, predictor: Predictor
) -> None:
    case = store.load_case(0, 2)
    crushing = LoadCase(case.nodes, 1e4 * case.forces)
    prediction = predictor(crushing, tolerance_mm=0.1)
    assert prediction.status is PredictionStatus.TOLERANCE_NOT_MET
    assert not prediction.status.usable


def test_without_calibration_a_tolerance_means_a_repair(
    store: Store, body: Body
) -> None:
    predictor, case = Predictor(Linear(body)), store.load_case(0, 2)
    assert predictor(case).error_estimate_mm is None
    assert predictor(case, tolerance_mm=1e3).status is PredictionStatus.REPAIRED


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf])
def test_bad_tolerance(store: Store, predictor: Predictor, tolerance: float) -> None:
    with pytest.raises(InputError, match="tolerance_mm must be > 0"):
        predictor(store.load_case(0, 0), tolerance_mm=tolerance)


def test_a_run_that_has_lost_its_calibration_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    run = tmp_path / "run"
    shutil.copytree(BUNDLED_RUN, run)
    whole = Predictor.load(run, warm=False)
    assert whole.calibration is not None
    assert not caplog.messages
    files = RunFolder(run)
    files.calibration.unlink()
    assert Predictor.load(run, warm=False).calibration is None
    assert [m for m in caplog.messages if f"lost its {files.calibration.name}" in m]


def test_nothing_speaks_for_a_quick_prediction_without_calibration(
    store: Store, body: Body
) -> None:
    predictor, case = Predictor(Linear(body)), store.load_case(0, 0)
    quick = predictor(case, estimate="quick")
    assert quick.status is PredictionStatus.NO_ERROR_ESTIMATE
    assert not quick.status.usable
    assert "neither a calibrated bound" in quick.reasons[0]
    assert predictor(case).status is PredictionStatus.OK, "the physical estimate does"


@pytest.mark.parametrize("wrong_by", [5.0, 2363.0, float("nan")])
def test_garbage_is_never_ok(store: Store, body: Body, wrong_by: float) -> None:
    """An untrained network's field, and one of its own making that is not finite."""
    case, truth = store.load_case(0, 2), store.displacement(0)[2]
    garbage = truth + wrong_by * np.sin(7 * body.mesh.points) * (truth != 0)
    predictor = Predictor(FromFunction(body, lambda _: garbage))
    for estimate in ("physical", "quick"):
        prediction = predictor(case, estimate=estimate)
        assert not prediction.status.usable
        assert prediction.reasons


def test_a_small_physical_estimate_outweighs_the_range(
    store: Store, body: Body, predictor: Predictor
) -> None:
    """A pull where training pushed, which this surrogate knows exactly."""
    case = store.load_case(0, 0)
    pull = LoadCase(case.nodes, -case.forces)
    exact = FiniteElementPredictor(body)(pull).displacement
    surrogate = FromFunction(body, lambda _: exact)
    calibrated = Predictor(surrogate, calibration=predictor.calibration)
    assert calibrated(pull).status is PredictionStatus.OK
    quick = calibrated(pull, estimate="quick")
    assert quick.status is PredictionStatus.OUTSIDE_TRAINED_RANGE
    assert "from the trained axis" in quick.reasons[0]


def test_load_on_a_fixed_point(store: Store, predictor: Predictor) -> None:
    case = LoadCase(store.fixed[:1], np.array([[0.0, 0.0, 1e-3]]))
    with pytest.raises(InputError, match="is fixed"):
        predictor(case)


def test_every_status_has_its_remedy() -> None:
    for status in PredictionStatus:
        assert len(status.remedy) > 20
        assert "\n" not in status.remedy


def test_files_call_usable_what_is_usable() -> None:
    assert {str(s) for s in PredictionStatus if s.usable} == set(USABLE)


def test_run_folder_round_trip(
    store: Store, body: Body, parts: tuple, tmp_path: Path
) -> None:
    """A loaded network answers as in memory, and takes its calibration with it."""
    model = build_model("physgnn", body, width=8)
    model.fit(store, parts[0])
    record = {"config": {"model": "physgnn", "options": {"width": 8}}}
    Checkpoint(model, record).save(tmp_path)
    case = store.load_case(9, 1)
    before = Predictor.load(tmp_path)
    expected = (
        model.eval()(model.encode(case)[None], graph_of(body))[0].detach().numpy()
    )
    np.testing.assert_allclose(before(case).displacement, expected, atol=1e-6)
    assert before(case).error_estimate_mm is None
    calibrated = calibrate_run(tmp_path, store, Split("path", *parts))
    assert RunFolder(tmp_path).calibration.is_file()
    assert RunFolder(tmp_path).relaxation.is_file()
    after = Predictor.load(tmp_path)
    assert after.calibration == calibrated
    assert after(case).error_estimate_mm is not None


def test_the_physical_estimate_is_near_and_its_bound_holds(
    store: Store, body: Body, parts: tuple
) -> None:
    """Of the linear answer, which is up to a tenth of a millimetre off."""
    linear = Linear(body)
    plain = Predictor(linear)
    relaxation = calibrate(linear, (RELAXATION, plain.error), store, parts[:2])
    predictor = Predictor(linear, relaxation=relaxation)
    held = []
    for path, level in parts[2]:
        found = predictor(store.load_case(path, level), estimate="physical")
        error = np.linalg.norm(
            found.displacement - store.displacement(path)[level], axis=1
        )
        assert found.likely_error_mm is not None
        assert 0.5 < found.likely_error_mm.max_mm / error.max() < 2.0
        assert 0.5 < found.likely_error_mm.mean_mm / error.mean() < 2.0
        assert found.error_estimate_mm is not None
        held.append(error.max() <= found.error_estimate_mm.max_mm)
    assert np.mean(held) >= 0.6  # promised 0.8 on average, on 4 paths of 3 levels


def test_only_the_physical_estimate_says_how_large_the_error_likely_is(
    store: Store, predictor: Predictor
) -> None:
    case = store.load_case(0, 0)
    assert predictor(case, estimate="quick").likely_error_mm is None
    assert predictor(case).likely_error_mm is not None


def test_unknown_estimate(store: Store, predictor: Predictor) -> None:
    with pytest.raises(InputError, match="must be one of physical, quick"):
        predictor(store.load_case(0, 0), estimate="guess")
