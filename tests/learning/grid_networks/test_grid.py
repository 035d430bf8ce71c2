"""Between a body's points and the grid about it."""

import numpy as np
import pytest
import torch

from physgnn.arrays import FloatArray
from physgnn.learning.graph import as_float32
from physgnn.learning.grid_networks.grid import BodyGrid, PointsOnGrid

NODES = 8


@pytest.fixture
def points() -> FloatArray:
    return np.random.default_rng(0).uniform(-30.0, 50.0, (200, 3))


def fields_on(grid: BodyGrid, columns: FloatArray) -> torch.Tensor:
    n = grid.nodes
    return as_float32(columns).T.reshape(1, -1, n, n, n)


def test_a_linear_field_on_the_grid_is_read_back_exactly(points: FloatArray) -> None:
    grid = BodyGrid.about(points, NODES)
    gradient = np.random.default_rng(1).normal(size=(3, 3))
    on_grid = fields_on(grid, grid.positions @ gradient.T + [1.0, 2.0, 3.0])
    read = PointsOnGrid(grid, points).gather(on_grid)[0].numpy()
    np.testing.assert_allclose(read, points @ gradient.T + [1.0, 2.0, 3.0], atol=1e-3)


def test_the_body_lies_within_the_grid(points: FloatArray) -> None:
    grid = BodyGrid.about(points, NODES)
    low, high = grid.positions.min(axis=0), grid.positions.max(axis=0)
    assert (points - low >= 0.99 * grid.spacing).all()
    assert (high - points >= 0.99 * grid.spacing).all()


def test_what_is_the_same_at_all_points_comes_back_from_the_grid(
    points: FloatArray,
) -> None:
    there = PointsOnGrid(BodyGrid.about(points, NODES), points)
    constant = torch.tensor([1.0, -2.0, 0.5]).expand(1, len(points), 3)
    chosen = torch.zeros(1, len(points))
    chosen[0, ::7] = 1.0
    fields, reached = there.scatter(constant, chosen)
    back = there.gather(fields)[0, ::7]
    torch.testing.assert_close(back, constant[0, ::7])
    assert set(reached.unique().tolist()) == {0.0, 1.0}
    assert not fields[:, :, reached[0, 0] == 0].any()


def test_a_node_has_the_weighted_mean_of_the_points_about_it() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [10.0, 10.0, 10.0]])
    grid = BodyGrid.about(corners, NODES)
    node = grid.positions.reshape(NODES, NODES, NODES, 3)[3, 4, 2]
    along = np.array([grid.spacing, 0.0, 0.0])
    near, far = node + 0.25 * along, node - 0.5 * along
    there = PointsOnGrid(grid, np.array([near, far]))
    values = torch.tensor([[[4.0], [1.0]]])
    fields, _ = there.scatter(values, torch.ones(1, 2))
    assert float(fields[0, 0, 3, 4, 2]) == pytest.approx(
        (0.75 * 4 + 0.5 * 1) / 1.25, rel=1e-4
    )


def test_points_that_are_not_chosen_do_not_count(points: FloatArray) -> None:
    there = PointsOnGrid(BodyGrid.about(points, NODES), points)
    values, chosen = torch.randn(2, len(points), 3), torch.zeros(2, len(points))
    chosen[:, :50] = 1.0
    fields, reached = there.scatter(values, chosen)
    values[:, 50:] = 1e6
    again, same = there.scatter(values, chosen)
    torch.testing.assert_close(again, fields)
    torch.testing.assert_close(same, reached)
