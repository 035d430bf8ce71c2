"""The local expansion, against the linear solution and the full solver."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.equilibrium.solver import SolverOptions, solve
from physgnn.mechanics.linear.direct_solver import make_linear_solver
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.expansions.local import LocalExpansion

MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(7500.0, 0.45)}
EXACT = SolverOptions(tolerance_mm=1e-7)
CORNER = np.array([1.2e-2, 3e-3, -3e-2])  # N; moves its point by more than 1 mm


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    return block_mesh(4, jitter=0.1)


@pytest.fixture(scope="module")
def node(mesh: TetMesh) -> int:
    return int(np.argmin(np.abs(mesh.points - [5.0, 5.0, 10.0]).sum(axis=1)))


def expansion(
    mesh: TetMesh, points: IntArray, state: FloatArray | None = None
) -> LocalExpansion:
    state = np.zeros_like(mesh.points) if state is None else state
    body = Body(mesh, MATERIALS)
    return LocalExpansion(body, state, points, make_linear_solver(body.pattern))


def around(mesh: TetMesh, node: int, radius: float) -> IntArray:
    distance = np.linalg.norm(mesh.points - mesh.points[node], axis=1)
    return np.flatnonzero(distance < radius)


def push(mesh: TetMesh, node: int, share: float = 1.0) -> FloatArray:
    force = np.zeros_like(mesh.points)
    force[node] = share * CORNER
    return force


def solved(mesh: TetMesh, node: int) -> FloatArray:
    path = LoadPath(np.array([node]), CORNER[None], np.array([0.5, 1.0]))
    solution = solve(mesh, path, materials=MATERIALS, options=EXACT)
    assert solution.converged
    return solution.displacement[-1]


def test_a_patch_of_all_points_is_the_whole_problem(mesh: TetMesh, node: int) -> None:
    answer = expansion(mesh, np.arange(mesh.n_points))(push(mesh, node))
    assert answer.converged
    truth = solved(mesh, node)
    assert np.abs(truth).max() > 1.0
    np.testing.assert_allclose(answer.displacement, truth, atol=2e-4)


def test_it_is_nearer_than_the_linear_solution(mesh: TetMesh, node: int) -> None:
    truth = solved(mesh, node)
    linear = RestState(Body(mesh, MATERIALS)).solve(push(mesh, node))
    answer = expansion(mesh, around(mesh, node, 5.1))(push(mesh, node))
    assert answer.converged
    error = np.abs(answer.displacement - truth).max()
    assert error < 0.5 * np.abs(linear - truth).max()


def test_small_loads_get_the_linear_solution_at_second_order(
    mesh: TetMesh, node: int
) -> None:
    local, rest = (
        expansion(mesh, around(mesh, node, 5.1)),
        RestState(Body(mesh, MATERIALS)),
    )
    shares = np.array([0.1, 0.05, 0.025])
    apart = [
        np.abs(
            local(push(mesh, node, s)).displacement - rest.solve(push(mesh, node, s))
        ).max()
        for s in shares
    ]
    slope = np.polyfit(np.log(shares), np.log(apart), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.15)


def test_no_load_no_displacement(mesh: TetMesh, node: int) -> None:
    answer = expansion(mesh, around(mesh, node, 5.1))(np.zeros_like(mesh.points))
    assert answer.converged
    assert not answer.displacement.any()


def test_the_patch_is_in_equilibrium_and_fixed_points_still(
    mesh: TetMesh, node: int
) -> None:
    points, force = around(mesh, node, 7.6), push(mesh, node)
    u = expansion(mesh, points)(force).displacement
    inner, inverted = internal_force(make_elements(mesh, MATERIALS), u)
    assert inverted < 0
    outside = mesh.cells[~np.isin(mesh.cells, points).all(axis=1)]
    deep = np.setdiff1d(points, outside)
    assert node in deep
    np.testing.assert_allclose(inner[deep], force[deep], atol=1e-6)
    assert not u[mesh.point_set("fixed")].any()


def test_an_equilibrium_is_the_solution_of_its_own_load(
    mesh: TetMesh, node: int
) -> None:
    truth = solved(mesh, node)
    answer = expansion(mesh, around(mesh, node, 2.6), truth)(push(mesh, node))
    np.testing.assert_allclose(answer.displacement, truth, atol=1e-5)


def test_expanding_about_a_solution_again_is_newtons_step(
    mesh: TetMesh, node: int
) -> None:
    truth, points = solved(mesh, node), around(mesh, node, 5.1)
    once = expansion(mesh, points)(push(mesh, node)).displacement
    twice = expansion(mesh, points, once)(push(mesh, node)).displacement
    assert np.abs(twice - truth).max() < 0.25 * np.abs(once - truth).max()


def test_an_unstable_state_is_refused(mesh: TetMesh, node: int) -> None:
    inverted = np.zeros_like(mesh.points)
    inverted[node] = [0.0, 0.0, -8.0]
    with pytest.raises(ValueError, match="not stable"):
        expansion(mesh, around(mesh, node, 2.6), inverted)
