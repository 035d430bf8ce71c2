"""Which answers a repair may begin at."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.relaxation import Relaxation
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.prediction import ErrorBound, LikelyError
from physgnn.prediction.repair_policy import (
    AIM,
    DEEPEST,
    UNSURE_BY,
    UNSURE_FROM,
    WRONG_BY,
    cautious_error,
    depth,
    good_enough,
    where_to_begin,
)

SIZES = st.floats(0.0, 100.0)


def pushed_in(body: Body, n_loaded: int, edges: float) -> tuple[LoadCase, np.ndarray]:
    """Return a load on so many points, and them so many mean edges from rest."""
    points, cells = body.mesh.points, body.mesh.cells
    nodes = body.mesh.point_set("loaded")[:n_loaded]
    displacement = np.zeros_like(points)
    for node in nodes:
        beside = np.setdiff1d(cells[(cells == node).any(axis=1)], node)
        mean = np.linalg.norm(points[beside] - points[node], axis=1).mean()
        displacement[node, 2] = -edges * mean
    return LoadCase(nodes, np.tile([0.0, 0.0, -1.0], (n_loaded, 1))), displacement


@pytest.mark.parametrize("n_loaded", [1, 3])
def test_depth_is_measured_in_edges_of_the_cells_there(
    body: Body, n_loaded: int
) -> None:
    case, displacement = pushed_in(body, n_loaded, 0.7)
    assert depth(body, case, displacement) == pytest.approx(0.7)


def test_many_points_move_together(body: Body) -> None:
    assert depth(body, *pushed_in(body, 4, 10.0)) == 0.0


def test_points_without_force_do_not_count(body: Body) -> None:
    case, far = pushed_in(body, 4, 10.0)
    case.forces[1:] = 0.0
    assert depth(body, case, far) == pytest.approx(10.0)
    assert depth(body, case, 0 * far) == 0.0


@pytest.mark.parametrize("exponent", [0.8, 1.0, 1.25])
def test_a_repair_begins_at_the_load_fraction_that_still_tells_its_state(
    body: Body, exponent: float
) -> None:
    case, near = pushed_in(body, 1, 0.99 * DEEPEST)
    assert where_to_begin(unwanted, body, case, near).load_fraction == 1.0
    case, far = pushed_in(body, 1, 2 * DEEPEST)

    def answer(part: LoadCase) -> np.ndarray:
        fraction = np.linalg.norm(part.forces) / np.linalg.norm(case.forces)
        return float(fraction) ** exponent * far

    start = where_to_begin(answer, body, case, far)
    part = LoadCase(case.nodes, start.load_fraction * case.forces)
    assert 0.2 < start.load_fraction < 0.9
    assert start.displacement is not None
    np.testing.assert_array_equal(start.displacement, answer(part))
    assert 0.6 * AIM < depth(body, part, start.displacement) / DEEPEST <= 1.0


@pytest.mark.parametrize("size", [1.0, np.nan])
def test_where_no_share_tells_it_begins_at_rest(body: Body, size: float) -> None:
    case, far = pushed_in(body, 1, 2 * DEEPEST)
    start = where_to_begin(lambda _: size * far, body, case, size * far)
    assert start.displacement is None
    assert start.load_fraction == 0.0


def test_an_answer_not_to_be_trusted_is_begun_at_rest(body: Body) -> None:
    case, near = pushed_in(body, 1, 0.1 * DEEPEST)
    assert where_to_begin(None, body, case, near).displacement is None


@pytest.mark.parametrize(("edges", "factor"), [(0.99, 1.0), (1.01, UNSURE_BY)])
def test_where_other_equilibria_lie_near_the_estimate_grows(
    body: Body, edges: float, factor: float
) -> None:
    case, displacement = pushed_in(body, 1, edges * UNSURE_FROM)
    error = 0.1 * displacement
    relaxed = Relaxation(displacement, error, 0 * error)
    np.testing.assert_array_equal(
        cautious_error(body, case, relaxed), factor * relaxed.error
    )


@given(bound=SIZES, likely=SIZES, tolerance=SIZES)
def test_good_enough_is_below_the_tolerance_by_bound_and_by_estimate(
    bound: float, likely: float, tolerance: float
) -> None:
    enough = good_enough(
        ErrorBound(bound, bound, 0.9), LikelyError(likely, likely), tolerance
    )
    assert enough == (bound <= tolerance and WRONG_BY * likely <= tolerance)
    assert not good_enough(None, LikelyError(likely, likely), tolerance)


def unwanted(_: LoadCase) -> np.ndarray:
    raise AssertionError("the answer to the whole load was good enough")
