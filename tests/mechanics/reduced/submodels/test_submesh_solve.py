"""What a patch held by its neighbours must find."""

import numpy as np
import pytest

from physgnn.geometry.mesh_topology import points_within
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solver import SolverOptions, solve
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.submodels.submesh_solve import solve_submesh

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}
Solved = tuple[Body, LoadCase, np.ndarray]


@pytest.fixture
def solved(block: TetMesh) -> Solved:
    """A force on one point, and its answer."""
    case = LoadCase(block.point_set("loaded")[5:6], np.array([[2e-2, 1e-2, -4e-2]]))
    path = LoadPath(case.nodes, case.forces, np.array([1.0]))
    options = SolverOptions(tolerance_mm=1e-8)
    answer = solve(block, path, materials=MATERIALS, options=options)
    return Body(block, MATERIALS), case, answer.displacement[0]


@pytest.mark.parametrize("reach", [1, 2])
def test_a_patch_finds_equilibrium_from_its_neighbours_alone(
    block: TetMesh, solved: Solved, reach: int
) -> None:
    body, case, truth = solved
    points = np.flatnonzero(points_within(block, case.nodes, reach))
    guess = truth.copy()
    guess[case.nodes] = 1e3  # the answer does not depend on what is inside
    force = case.on_points(block.n_points)
    solved = solve_submesh(body, points, guess, force)
    assert solved is not None
    np.testing.assert_allclose(solved, truth, atol=1e-5)


def test_no_force_and_neighbours_at_rest_give_rest(
    block: TetMesh, solved: Solved
) -> None:
    body, case, _ = solved
    points = np.flatnonzero(points_within(block, case.nodes, 2))
    rest = np.zeros_like(block.points)
    solved = solve_submesh(body, points, rest, rest)
    assert solved is not None
    np.testing.assert_allclose(solved, 0.0, atol=1e-9)


def test_neighbours_turned_inside_out_have_no_solution(
    block: TetMesh, solved: Solved
) -> None:
    body, case, truth = solved
    points = np.flatnonzero(points_within(block, case.nodes, 1))
    mirrored = truth - 2.0 * block.points * np.array([1.0, 0.0, 0.0])
    force = case.on_points(block.n_points)
    assert solve_submesh(body, points, mirrored, force) is None
