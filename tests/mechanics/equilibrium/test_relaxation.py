"""A few steps from a guess tell how far off it was."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import (
    LoadCase,
    LoadPath,
    NeoHookean,
    deformation_gradient,
    solve,
)
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}


@pytest.fixture(scope="module")
def solved(block: TetMesh) -> tuple[LoadCase, np.ndarray]:
    nodes = block.point_set("loaded")
    forces = np.tile([0.3, 0.1, 1.0], (len(nodes), 1)) * 0.1 / len(nodes)
    solution = solve(
        block, LoadPath(nodes, forces, np.arange(1, 6) / 5), materials=MATERIALS
    )
    return LoadCase(nodes, forces), solution.displacement[-1]


@pytest.fixture(scope="module", params=["tet4", "tet4-averaged"])
def element(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def sizes(field: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(field, axis=1)
    return np.array([length.mean(), length.max()])


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31), size=st.floats(0.01, 0.3))
@example(seed=501, size=0.298828125)  # 2.09 in the mean
def test_the_error_is_estimated_within_a_factor_of_two_or_so(block, solved, seed, size):
    """Whether the guess is rough all over or wrong in few places."""
    case, truth = solved
    rng = np.random.default_rng(seed)
    wrong = rng.normal(size=truth.shape) * (rng.random((len(truth), 1)) < 0.3) * size
    wrong[block.point_set("fixed")] = 0.0
    guess = truth + wrong
    found = WarmStartSolver(Body(block, MATERIALS)).relax(case, guess)
    ratio = sizes(found.error) / sizes(guess - truth)
    assert (ratio > 0.5).all()
    assert (ratio < 2.5).all()


def test_cells_inside_out_are_turned_back(block, solved):
    case, truth = solved
    inside = np.setdiff1d(np.arange(len(truth)), block.point_set("fixed"))
    guess = truth.copy()
    guess[inside[::9], 2] -= 4.0  # cells have sides of 3.3
    assert (np.linalg.det(deformation_gradient(block, guess)) <= 0).any()
    found = WarmStartSolver(Body(block, MATERIALS)).relax(case, guess)
    assert (np.linalg.det(deformation_gradient(block, found.displacement)) > 0).all()


def test_what_was_moved_leads_from_the_guess(block, solved, element):
    case, truth = solved
    found = WarmStartSolver(Body(block, MATERIALS, element=element)).relax(
        case, 0.9 * truth
    )
    np.testing.assert_allclose(
        found.displacement - 0.9 * truth, found.moved, atol=1e-12
    )
    assert not found.error[block.point_set("fixed")].any()
    assert (sizes(found.error) >= sizes(found.moved)).all()
    assert (sizes(found.last) <= sizes(found.moved)).all()


def test_at_equilibrium_there_is_nothing_to_move(block, solved):
    case, truth = solved
    assert (
        sizes(WarmStartSolver(Body(block, MATERIALS)).relax(case, truth).error)[1]
        < 1e-2
    )
