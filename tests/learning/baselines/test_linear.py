"""The linear solution adds up, and is the limit of small loads."""

import numpy as np

from physgnn.dataset.storage.store import Store
from physgnn.learning.baselines.linear import Linear
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.finite_element import FiniteElementPredictor


def test_superposition(store: Store, body: Body) -> None:
    first, second = store.load_case(0, 2), store.load_case(1, 2)
    both = LoadCase(first.nodes, 2 * first.forces - second.forces)
    answer = Linear(body).predict
    expected = 2 * answer(first) - answer(second)
    np.testing.assert_allclose(answer(both), expected, atol=1e-10)


def test_small_loads_converge_to_it_quadratically(store: Store, body: Body) -> None:
    """What linear elasticity leaves out is of second order in the load."""
    case = store.load_case(0, 2)
    answer, solve = Linear(body).predict, FiniteElementPredictor(body)
    errors = []
    for factor in (1.0, 0.5, 0.25):
        weaker = LoadCase(case.nodes, factor * case.forces)
        error = answer(weaker) - solve(weaker).displacement
        errors.append(np.linalg.norm(error, axis=1).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (np.abs(rates - 2) < 0.35).all(), rates
