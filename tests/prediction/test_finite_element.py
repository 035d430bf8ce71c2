"""The solver behind the predictors' interface."""

import numpy as np

from physgnn.dataset.storage.store import Store
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.prediction import PredictionStatus


def test_gives_the_solution_of_the_dataset(store: Store, body: Body) -> None:
    solve = FiniteElementPredictor(body)
    for level in (0, 2):
        prediction = solve(store.load_case(3, level))
        truth = store.displacement(3)[level]
        np.testing.assert_allclose(prediction.displacement, truth, atol=1e-3)
        assert prediction.status is PredictionStatus.OK
        assert prediction.error_estimate_mm is not None
        assert prediction.error_estimate_mm.max_mm <= 1e-3


def test_a_load_it_cannot_reach_has_no_good_status(store: Store, body: Body) -> None:
    case = store.load_case(0, 2)
    crushing = LoadCase(case.nodes, 1e4 * case.forces)
    prediction = FiniteElementPredictor(body)(crushing)
    assert prediction.status is PredictionStatus.TOLERANCE_NOT_MET
    assert prediction.error_estimate_mm is None
    assert np.isfinite(prediction.displacement).all()
