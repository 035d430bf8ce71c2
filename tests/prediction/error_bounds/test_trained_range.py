"""Loads like those of training are inside, others outside for a stated reason."""

import json
from dataclasses import asdict

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.error_bounds.trained_range import TrainedRange


def cases(n: int, seed: int = 0) -> list[LoadCase]:
    rng = np.random.default_rng(seed)
    return [
        LoadCase(np.array([3, 5, 8]), [0.0, 0.0, -1.0] + 0.3 * rng.normal(size=(3, 3)))
        for _ in range(n)
    ]


@given(st.integers(1, 20), st.integers(0, 1000))
def test_training_loads_are_inside(n: int, seed: int) -> None:
    loads = cases(n, seed)
    trained = TrainedRange.from_cases(loads)
    assert not any(trained.reasons_outside(case) for case in loads)


@given(st.floats(0.01, 1.0))
def test_a_weaker_load_is_inside(factor: float) -> None:
    trained, case = TrainedRange.from_cases(cases(9)), cases(9)[4]
    weaker = LoadCase(case.nodes, factor * case.forces)
    assert trained.reasons_outside(weaker) == []


def test_reasons() -> None:
    trained, case = TrainedRange.from_cases(cases(9)), cases(9)[0]
    one = LoadCase(case.nodes[:1], case.forces[:1])
    elsewhere = LoadCase(case.nodes + 1, case.forces)
    (reason,) = trained.reasons_outside(LoadCase(case.nodes, -case.forces))
    assert "from the trained axis" in reason
    (reason,) = trained.reasons_outside(elsewhere)
    assert reason.startswith("3 loaded nodes never")
    assert any("trained on 3 or more" in r for r in trained.reasons_outside(one))
    strong = trained.reasons_outside(LoadCase(case.nodes, 9 * case.forces))
    assert any("N in all" in r for r in strong)
    assert any("N on one node" in r for r in strong)


def test_json_round_trip() -> None:
    trained = TrainedRange.from_cases(cases(5))
    assert TrainedRange.from_json(json.loads(json.dumps(asdict(trained)))) == trained


def test_loads_without_a_resultant_leave_the_direction_free() -> None:
    pinch = LoadCase(np.array([1, 2]), np.array([[1.0, 0, 0], [-1.0, 0, 0]]))
    turned = LoadCase(np.array([1, 2]), np.array([[0, 1.0, 0], [0, 0.9, 0]]))
    assert TrainedRange.from_cases([pinch]).reasons_outside(turned) == []
