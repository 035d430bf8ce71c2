"""Loads are checked when made, and against the mesh they are put on."""

import numpy as np
import pytest

from physgnn.errors import InputError
from physgnn.mechanics import LoadCase, LoadPath

ONE = np.array([[0.0, 0.0, -1.0]])


@pytest.mark.parametrize(
    ("nodes", "forces", "message"),
    [
        ([], np.zeros((0, 3)), "n_loaded = 0"),
        ([3], np.zeros((2, 3)), r"got \(2, 3\)"),
        ([3.5], ONE, "must be integers"),
        ([3], ONE * np.nan, "force on node 3 is not"),
        ([3], np.full((1, 3), np.inf), "must be finite"),
        ([3], ONE * 0, "must not all be zero"),
        ([3, 3], np.repeat(ONE, 2, 0), "node 3 is repeated"),
    ],
)
def test_wrong_forces_are_refused(nodes, forces, message):
    with pytest.raises(InputError, match=message):
        LoadCase(np.array(nodes), forces)
    with pytest.raises(InputError, match=message):
        LoadPath(np.array(nodes), forces, np.array([1.0]))


@pytest.mark.parametrize(
    "factors", [[], [0.0, 1.0], [0.5, 0.5], [1.0, 0.5], [0.5, 1.1], [np.nan]]
)
def test_wrong_load_factors_are_refused(factors):
    with pytest.raises(InputError, match="load_factors must"):
        LoadPath(np.array([3]), ONE, np.array(factors))


def test_loads_must_be_on_free_points_of_the_mesh(block):
    fixed = block.point_set("fixed")
    with pytest.raises(
        InputError, match=r"loaded node 999 is not in the mesh \(0…63\)"
    ):
        LoadCase(np.array([999]), ONE).check_against(block, fixed)
    with pytest.raises(InputError, match=f"loaded node {fixed[0]} is fixed"):
        LoadCase(fixed[:1], ONE).check_against(block, fixed)


def test_a_level_of_a_path_is_a_case():
    path = LoadPath(np.array([3, 1]), np.eye(3)[:2], np.array([0.25, 1.0]))
    case = path.case(0)
    np.testing.assert_array_equal(case.nodes, [3, 1])
    np.testing.assert_array_equal(case.forces, np.eye(3)[:2] / 4)
    field = case.on_points(5)
    np.testing.assert_array_equal(field[[3, 1]], case.forces)
    assert np.abs(field).sum() == 0.5
