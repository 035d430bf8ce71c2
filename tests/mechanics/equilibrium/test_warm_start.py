"""Whatever it starts from, an warm_start ends in the equilibrium of the load path."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadCase, LoadPath, NeoHookean, Status, solve
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tangent import assemble_tangent, make_pattern
from physgnn.mechanics.elements.tet4 import make_elements
from physgnn.mechanics.equilibrium import quasi_newton
from physgnn.mechanics.equilibrium.full_newton import Newton
from physgnn.mechanics.equilibrium.reference_states import ReferenceState
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.linear.direct_solver import make_linear_solver

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}
TOLERANCE_MM = 1e-3


def load(mesh: TetMesh, total_n: float) -> LoadCase:
    """The top of the block pulled up and sideways, unevenly."""
    nodes = mesh.point_set("loaded")
    forces = np.tile([0.3, 0.1, 1.0], (len(nodes), 1)) * total_n / len(nodes)
    return LoadCase(nodes, forces * np.linspace(0.5, 1.5, len(nodes))[:, None])


@pytest.fixture(scope="module")
def solved(block):
    case = load(block, 0.2)
    path = LoadPath(case.nodes, case.forces, np.arange(1, 11) / 10)
    solution = solve(block, path, materials=MATERIALS)
    assert solution.converged
    assert np.abs(solution.displacement[-1]).max() > 2.0, "of a 10 mm block"
    return case, solution.displacement


@pytest.fixture(scope="module")
def warm_start(block) -> WarmStartSolver:
    return WarmStartSolver(Body(block, MATERIALS))


def guesses(states: np.ndarray) -> dict[str, np.ndarray | None]:
    truth, rng = states[-1], np.random.default_rng(0)
    moved = np.abs(truth).max(axis=1, keepdims=True) > 0
    return {
        "truth": truth,
        "frame before": states[-2],
        "zero": np.zeros_like(truth),
        "far too much": 2.0 * truth,
        "inverted cells": truth + moved * rng.normal(size=truth.shape),
        "opposite": -truth,
        "not a number": np.full_like(truth, np.nan),
        "none": None,
    }


@pytest.mark.parametrize("name", guesses(np.zeros((2, 1, 3))))
def test_the_guess_does_not_show_in_the_solution(warm_start, solved, name):
    case, states = solved
    found = warm_start.solve(case, guesses(states)[name], tolerance_mm=TOLERANCE_MM)
    assert found.status == Status.CONVERGED
    error = np.linalg.norm(found.displacement - states[-1], axis=1).max()
    assert error < TOLERANCE_MM


def test_what_converges_is_within_the_tolerance_of_full_newton(
    block, warm_start, solved
):
    case, states = solved
    newton = Newton(Body(block, MATERIALS))
    for tolerance_mm in (1e-1, 1e-2, 1e-4):
        found = warm_start.solve(case, states[4], tolerance_mm=tolerance_mm)
        exact = newton.solve(case, found.displacement)
        assert exact is not None
        error = np.linalg.norm(found.displacement - exact, axis=1).max()
        assert error < tolerance_mm


def test_reference_states_do_not_change_the_solution(block, solved):
    case, states = solved
    body = Body(block, MATERIALS)
    known = ReferenceState.of(body, states[4])
    warm_start = WarmStartSolver(body, nearest=lambda _: known)
    wild = states[4] + np.random.default_rng(1).normal(size=states[4].shape)
    found = warm_start.solve(case, wild, tolerance_mm=TOLERANCE_MM)
    assert found.status == Status.CONVERGED
    np.testing.assert_allclose(found.displacement, states[-1], atol=TOLERANCE_MM)


def test_a_good_guess_costs_one_factorisation_and_one_to_prove_it(warm_start, solved):
    case, states = solved
    found = warm_start.solve(case, states[-1] * 1.001, tolerance_mm=TOLERANCE_MM)
    assert found.origin == "guess"
    assert found.counts["factorisations"] == 2
    again = warm_start.solve(case, found.displacement, tolerance_mm=TOLERANCE_MM)
    assert again.counts["factorisations"] == 1, "it proves itself"


def test_a_large_body_is_factorised_only_to_prove_it(block, solved, monkeypatch):
    """The way there begins with the reference state's factor, renewed in part."""
    monkeypatch.setattr(quasi_newton, "LEAST_UNKNOWNS", 0)
    case, states = solved
    body = Body(block, MATERIALS)
    near = ReferenceState.of(body, states[-2])
    fresh = WarmStartSolver(body, nearest=lambda _: near)
    guess = states[-2] + 0.9 * (states[-1] - states[-2])
    found = fresh.solve(case, guess, tolerance_mm=TOLERANCE_MM)
    assert found.status == Status.CONVERGED
    assert found.origin == "guess"
    assert found.counts["factorisations"] == 1
    assert found.counts["partial_renewals"] == 1
    error = np.linalg.norm(found.displacement - states[-1], axis=1).max()
    assert error < TOLERANCE_MM


@pytest.mark.parametrize("name", guesses(np.zeros((2, 1, 3))))
def test_nor_does_it_in_that_of_a_large_body(block, solved, name, monkeypatch):
    monkeypatch.setattr(quasi_newton, "LEAST_UNKNOWNS", 0)
    fresh = WarmStartSolver(Body(block, MATERIALS))
    test_the_guess_does_not_show_in_the_solution(fresh, solved, name)


def test_a_load_without_equilibrium_has_no_good_status(block, warm_start, solved):
    case, states = solved
    crushing = LoadCase(case.nodes, -1e4 * case.forces)
    found = warm_start.solve(crushing, states[-1], tolerance_mm=TOLERANCE_MM)
    assert found.status != Status.CONVERGED
    assert np.isfinite(found.displacement).all()
    assert not found.displacement[block.point_set("fixed")].any()


def test_the_same_every_time(warm_start, solved):
    case, states = solved
    first, second = (
        warm_start.solve(case, states[3], tolerance_mm=TOLERANCE_MM).displacement
        for _ in range(2)
    )
    np.testing.assert_array_equal(first, second)


def test_what_converges_is_stable(block, warm_start, solved):
    case, states = solved
    found = warm_start.solve(case, -states[-1], tolerance_mm=TOLERANCE_MM)
    pattern = make_pattern(block.cells, block.n_points, block.point_set("fixed"))
    elements = make_elements(block, MATERIALS)
    data, _ = assemble_tangent(elements, pattern, found.displacement)
    assert make_linear_solver(pattern).factorize(data)


def test_of_two_equilibria_the_load_reaches_the_one_followed_to():
    """Level 27 is the last before the body snaps through; beyond lies another state."""
    mesh = block_mesh(4)
    materials = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
    force = 0.15 * np.array([[0.552, -0.006, -0.834]])
    path = LoadPath(np.array([64]), force, np.arange(1, 31) / 30)
    states = solve(mesh, path, materials=materials).displacement
    warm_start = WarmStartSolver(Body(mesh, materials))
    misled = warm_start.solve(path.case(26), states[-1], tolerance_mm=TOLERANCE_MM)
    assert misled.status == Status.CONVERGED, "a stable equilibrium, but another one"
    assert np.linalg.norm(misled.displacement - states[26], axis=1).max() > 5.0
    for level in (26, 28):  # before it snaps and after
        followed = warm_start.solve(path.case(level), tolerance_mm=TOLERANCE_MM)
        assert followed.origin == "path"
        np.testing.assert_allclose(followed.displacement, states[level], atol=1e-3)
        begun = warm_start.solve(
            path.case(level),
            0.99 * states[14],
            load_fraction=0.5,
            tolerance_mm=TOLERANCE_MM,
        )
        assert begun.origin == "path"
        np.testing.assert_allclose(begun.displacement, states[level], atol=1e-3)


def test_the_last_try_reaches_what_the_solver_reaches_and_nothing_but_equilibria():
    """Loads near snap-throughs, where short steps and a tight tolerance decide.

    Rounding, which differs between processors, may decide whether a snap-through is
    passed. What is found where the solver stops must then be an equilibrium.
    """
    mesh, rng = block_mesh(4), np.random.default_rng(1)
    materials = {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)}
    body = Body(mesh, materials)
    warm_start, newton = WarmStartSolver(body), Newton(body)
    snaps = 0
    for node in rng.choice(mesh.point_set("loaded"), 12, replace=False):
        direction = rng.normal(size=3)
        force = 0.2 * direction[None] / np.linalg.norm(direction)
        path = LoadPath(node[None], force, np.arange(1, 31) / 30)
        solution = solve(mesh, path, materials=materials)
        snaps += "snapped" in solution.message
        for level in (29, 10):
            found = warm_start.solve(path.case(level), tolerance_mm=0.1)
            solved = solution.status[level] == Status.CONVERGED
            if solved:
                assert found.status == Status.CONVERGED
                missed = found.displacement - solution.displacement[level]
                assert np.abs(missed).max() < 0.1
            elif found.status == Status.CONVERGED:
                away_mm = newton.distance(path.case(level), found.displacement)
                assert away_mm < 0.1
    assert snaps >= 3


def test_the_rest_of_a_load_is_followed_from_the_fraction_a_guess_belongs_to(
    warm_start, solved
):
    case, states = solved
    begun, from_rest, far = (
        warm_start.solve(case, guess, load_fraction=part, tolerance_mm=TOLERANCE_MM)
        for guess, part in ((states[7], 0.8), (None, 0.0), (0.5 * states[7], 0.8))
    )
    for found in (begun, from_rest, far):
        assert found.origin == "path"
        assert found.status == Status.CONVERGED
        error = np.linalg.norm(found.displacement - states[-1], axis=1).max()
        assert error < TOLERANCE_MM
    assert begun.counts["residuals"] < 0.6 * from_rest.counts["residuals"]
    assert far.counts["residuals"] > from_rest.counts["residuals"], "not trusted"


def test_a_guess_far_from_where_it_leads_is_not_trusted(warm_start, solved):
    case, states = solved
    far = warm_start.solve(case, 0.5 * states[-1], tolerance_mm=TOLERANCE_MM)
    near = warm_start.solve(case, 0.95 * states[-1], tolerance_mm=TOLERANCE_MM)
    assert (far.origin, near.origin) == ("path", "guess")
