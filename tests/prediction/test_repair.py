"""Which answers a repair may begin at."""

import numpy as np
import pytest

from physgnn.learning.interface import Body
from physgnn.mechanics.loads import LoadCase
from physgnn.prediction.repair import FARTHEST_IN, chooses_a_state


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
def test_one_far_in_does_not_choose_among_equilibria(body: Body, n_loaded: int) -> None:
    case, near = pushed_in(body, n_loaded, 0.99 * FARTHEST_IN)
    assert chooses_a_state(body, case, near)
    case, far = pushed_in(body, n_loaded, 1.01 * FARTHEST_IN)
    assert not chooses_a_state(body, case, far)


def test_many_points_move_together(body: Body) -> None:
    assert chooses_a_state(body, *pushed_in(body, 4, 10.0))


def test_points_without_force_do_not_count(body: Body) -> None:
    case, far = pushed_in(body, 4, 10.0)
    case.forces[1:] = 0.0
    assert not chooses_a_state(body, case, far)
    assert chooses_a_state(body, case, 0 * far)
