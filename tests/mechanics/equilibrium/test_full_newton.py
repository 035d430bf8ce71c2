"""The yardstick itself: quadratic, exact, and honest where there is nothing."""

import numpy as np
import pytest

from physgnn.mechanics import (
    Gravity,
    LoadCase,
    LoadPath,
    NeoHookean,
    PrescribedDisplacement,
    SurfacePressure,
    faces_within,
    solve,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.solver import Solver

MATERIALS = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}


@pytest.fixture(scope="module")
def case(block):
    nodes = block.point_set("loaded")
    return LoadCase(nodes, np.tile([2e-3, 1e-3, 5e-3], (len(nodes), 1)))


def test_newton_reaches_equilibrium_to_rounding(block, case):
    u = Newton(Body(block, MATERIALS)).solve(case, np.zeros_like(block.points))
    force, _ = internal_force(make_elements(block, MATERIALS), u)
    load = case.on_points(block.n_points)
    free = np.setdiff1d(np.arange(block.n_points), block.point_set("fixed"))
    np.testing.assert_allclose(force[free], load[free], atol=1e-14)


def test_distance_finds_a_planted_error_and_clears_the_path_solver(block, case):
    newton = Newton(Body(block, MATERIALS))
    path = LoadPath(case.nodes, case.forces, np.array([0.5, 1.0]))
    u = solve(block, path, materials=MATERIALS).displacement[-1]
    assert newton.distance(case, u) < 1e-4
    wrong = u.copy()
    wrong[case.nodes[0]] += [0.0, 0.0, 0.05]
    assert newton.distance(case, wrong) == pytest.approx(0.05, rel=1e-2)


def test_no_equilibrium_is_an_infinite_distance(block):
    node = block.point_set("loaded")[5]
    case = LoadCase(np.array([node]), np.array([[0.0, 0.0, -5.0]]))
    newton = Newton(Body(block, MATERIALS))
    assert newton.distance(case, np.zeros_like(block.points)) == (np.inf)


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_all_loads_on_either_element(block, case, element):
    """The path solver never sees how loads change with u, and still ends here."""
    top = block.point_set("loaded")
    more = (
        SurfacePressure(faces_within(block, "loaded"), 100.0),
        Gravity((0, 1, -1), fluid_level_mm=5.0),
        PrescribedDisplacement(top[[0, 7]], np.array([[0, 0, -0.3], [0.1, 0, -0.2]])),
    )
    path = LoadPath(case.nodes[[5]], case.forces[[5]], np.array([0.5, 1.0]), more)
    body = Body(block, MATERIALS, element=element)
    found = Solver(body).solve(path).displacement
    newton = Newton(body)
    assert newton.distance(path, found[0], 0.5) < 1e-4
    assert newton.distance(path, found[1]) < 1e-4
    exact = newton.solve(path, found[1])
    np.testing.assert_array_equal(exact[top[[0, 7]]], more[2].displacement)
    assert newton.distance(case, np.zeros_like(exact)) > 0.1  # other points are held
