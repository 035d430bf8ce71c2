import numpy as np
import pytest

from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.calibration import Calibration
from physgnn.prediction.linear import linear_answer
from physgnn.prediction.predictor import Predictor
from physgnn.prediction.trained_range import TrainedRange
from physgnn.serving import live_predictor as module
from physgnn.serving.live_predictor import linear_on, live_predictor


@pytest.fixture(scope="module")
def case(body: Body) -> LoadCase:
    nodes = body.mesh.point_set("loaded")[2:9]
    forces = np.random.default_rng(0).normal(size=(len(nodes), 3)) * 1e-3
    return LoadCase(nodes, forces)


def test_the_product_is_the_linear_solution(body: Body, case: LoadCase) -> None:
    fast = linear_on(body, body.mesh.point_set("loaded"))(case)
    exact = linear_answer(body)(case)
    np.testing.assert_allclose(fast, exact, atol=1e-5 * np.abs(exact).max())


def test_a_matrix_that_does_not_fit_is_a_back_solve(
    body: Body, case: LoadCase, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_BYTES", 0)
    monkeypatch.setattr(module, "_columns", None)
    answer = linear_on(body, case.nodes)(case)
    np.testing.assert_array_equal(answer, linear_answer(body)(case))


@pytest.mark.parametrize("times", [0.5, 5.0])
def test_a_live_prediction_is_the_runs_own(
    body: Body, case: LoadCase, times: float
) -> None:
    linear = linear_answer(body)
    calibration = Calibration(
        "correction", 0.9, 0.3, 0.7, 9, 9, TrainedRange.from_cases([case])
    )
    network = Predictor(body, lambda c: 0.8 * linear(c), calibration=calibration)
    live = live_predictor(network, linear_on(body, case.nodes))
    wanted, got = (
        predict(LoadCase(case.nodes, times * case.forces))
        for predict in (network, live)
    )
    np.testing.assert_array_equal(got.displacement, wanted.displacement)
    assert got.status == wanted.status
    assert got.error_estimate_mm.max_mm == pytest.approx(
        wanted.error_estimate_mm.max_mm, rel=1e-4
    )
