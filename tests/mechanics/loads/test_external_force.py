"""Loads alone and together: patch test by displacement, equilibrium, conflicts."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.errors import InputError
from physgnn.mechanics import (
    Gravity,
    LoadPath,
    NeoHookean,
    PrescribedDisplacement,
    Solver,
    SolverOptions,
    SurfacePressure,
    faces_within,
    solve,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.loads.external_force import Loading

SOFT = NeoHookean(3000.0, 0.45)
MATERIALS = {0: SOFT, 1: SOFT}
TIGHT = {"tolerance_mm": 1e-9}
ONE = np.array([1.0])


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_prescribing_an_affine_boundary_makes_the_whole_body_affine(element):
    """The patch test: u = z a is zero on the fixed bottom, whatever a is."""
    mesh = block_mesh(3, jitter=0.2)
    target = mesh.points[:, 2:] * [0.3, -0.2, 0.25]
    sides = ((mesh.points == 0) | (mesh.points == 10)).any(axis=1)
    moved = np.flatnonzero(sides & (mesh.points[:, 2] > 0))
    path = LoadPath.of(
        np.array([0.5, 1.0]), PrescribedDisplacement(moved, target[moved])
    )
    body = Body(mesh, MATERIALS, element=element)
    solution = Solver(body, options=SolverOptions(**TIGHT)).solve(path)
    assert solution.converged and solution.residual.max() < 1e-7
    np.testing.assert_allclose(solution.displacement[-1], target, atol=1e-7)
    np.testing.assert_allclose(solution.displacement[0], target / 2, atol=1e-7)


def test_pushed_points_arrive_and_react(block):
    """A point pushed to a place needs the force that, applied, pushes it there."""
    node = block.point_set("loaded")[5:6]
    push = PrescribedDisplacement(node, np.array([[0.2, 0.0, -0.5]]))
    options = SolverOptions(**TIGHT)
    solver = Solver(Body(block, MATERIALS), options=options)
    u = solver.solve(LoadPath.of(ONE, push)).displacement[-1]
    np.testing.assert_array_equal(u[node], push.displacement)
    needed = internal_force(make_elements(block, MATERIALS), u)[0][node]
    same = solver.solve(LoadPath(node, needed, ONE)).displacement[-1]
    np.testing.assert_allclose(same, u, atol=1e-6)


def all_loads(mesh):
    """Force, pressure, gravity and pushed points at once."""
    top = mesh.point_set("loaded")
    return LoadPath(
        top[:3],
        np.tile([1e-3, 0.0, -1e-3], (3, 1)),
        np.array([0.5, 1.0]),
        more=(
            SurfacePressure(faces_within(mesh, "loaded"), 100.0),
            Gravity((0.0, 1.0, -1.0), fluid_level_mm=3.0),
            PrescribedDisplacement(top[-2:], np.full((2, 3), 0.3)),
        ),
    )


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_all_loads_together_are_in_equilibrium(block, element):
    path = all_loads(block)
    body = Body(block, MATERIALS, element=element)
    solution = Solver(body, options=SolverOptions(**TIGHT)).solve(path)
    assert solution.converged and solution.residual.max() < 1e-7
    elements = body.elements
    loading = Loading(block, path, block.point_set("fixed"))
    held = np.union1d(block.point_set("fixed"), loading.held)
    free = np.setdiff1d(np.arange(block.n_points), held)
    for factor, u in zip(path.load_factors, solution.displacement, strict=True):
        force, _ = internal_force(elements, u)
        np.testing.assert_allclose(
            force[free], loading.force(u, factor)[free], atol=1e-9
        )
        reactions = (force - loading.force(u, factor))[held].sum(axis=0)
        total = loading.force(u, factor).sum(axis=0)
        np.testing.assert_allclose(reactions, -total, atol=1e-8)


def test_forces_of_all_loads_add_up(block):
    path = all_loads(block)
    u = np.random.default_rng(0).uniform(-0.2, 0.2, block.points.shape)
    fixed = block.point_set("fixed")
    total = Loading(block, path, fixed).force(u, 0.7)
    alone = [
        Loading(block, LoadPath.of(path.load_factors, load), fixed).force(u, 0.7)
        for load in path.more
    ]
    dead = LoadPath(path.nodes, path.forces, path.load_factors)
    alone.append(Loading(block, dead, fixed).force(u, 0.7))
    np.testing.assert_allclose(sum(alone), total, atol=1e-15)


def test_a_solver_forgets_the_points_of_the_path_before(block):
    solver = Solver(Body(block, MATERIALS), options=SolverOptions(**TIGHT))
    top = block.point_set("loaded")
    dead = LoadPath(top[:1], np.array([[0.0, 0.0, -2e-3]]), ONE)
    before = solver.solve(dead).displacement
    solver.solve(all_loads(block))
    np.testing.assert_array_equal(solver.solve(dead).displacement, before)


def test_loads_that_claim_one_point_are_refused(block):
    top, fixed = block.point_set("loaded"), block.point_set("fixed")
    push = PrescribedDisplacement(top[:1], np.ones((1, 3)))
    for path, message in (
        (LoadPath.of(ONE, push, push), "name the same point"),
        (LoadPath(top[:1], np.ones((1, 3)), ONE, (push,)), "is fixed"),
        (
            LoadPath.of(ONE, PrescribedDisplacement(fixed[:1], np.ones((1, 3)))),
            "is fixed",
        ),
        (
            LoadPath.of(ONE, PrescribedDisplacement([999], np.ones((1, 3)))),
            "must index",
        ),
    ):
        with pytest.raises(InputError, match=message):
            solve(block, path, materials=MATERIALS)


@pytest.mark.parametrize(
    ("nodes", "displacement", "message"),
    [
        ([], np.zeros((0, 3)), "one or more integers"),
        ([1], np.zeros((2, 3)), "one row a node"),
        ([1], np.full((1, 3), np.nan), "finite"),
        ([1, 1], np.zeros((2, 3)), "named once"),
    ],
)
def test_a_wrong_prescription_is_refused(nodes, displacement, message):
    with pytest.raises(InputError, match=message):
        PrescribedDisplacement(nodes, displacement)


def test_a_path_needs_some_load_and_a_case_is_forces_alone():
    with pytest.raises(InputError, match="n_loaded = 0"):
        LoadPath.of(ONE)
    with pytest.raises(InputError, match=r"also has Gravity"):
        LoadPath.of(ONE, Gravity((0.0, 0.0, -1.0))).case(0)
