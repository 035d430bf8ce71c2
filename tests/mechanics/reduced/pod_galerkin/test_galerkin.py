"""Small spaces: when they hold the solution, they find it."""

import numpy as np
import pytest

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force, make_elements
from physgnn.mechanics.equilibrium.solver import SolverOptions, solve
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.pod_galerkin.ecsw import cell_works, weigh_cells
from physgnn.mechanics.reduced.pod_galerkin.galerkin import GalerkinBody

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
EXACT = SolverOptions(tolerance_mm=1e-7)


@pytest.fixture(scope="module")
def states(block: TetMesh) -> FloatArray:
    """Equilibria at four levels of a push on the top."""
    top = block.point_set("loaded")
    path = LoadPath(top, np.tile([2e-3, 5e-4, -4e-3], (len(top), 1)), LEVELS)
    solution = solve(block, path, materials=MATERIALS, options=EXACT)
    assert solution.converged
    return solution.displacement


LEVELS = np.arange(1, 5) / 4


def top_force(mesh: TetMesh) -> FloatArray:
    force = np.zeros_like(mesh.points)
    force[mesh.point_set("loaded")] = [2e-3, 5e-4, -4e-3]
    return force


def orthonormal(fields: FloatArray) -> FloatArray:
    basis = np.linalg.qr(fields.reshape(len(fields), -1).T)[0]
    return basis.T.reshape(-1, *fields.shape[1:])


def test_all_points_free_is_the_whole_problem(
    block: TetMesh, states: FloatArray
) -> None:
    free = np.setdiff1d(np.arange(block.n_points), block.point_set("fixed"))
    elements = make_elements(block, MATERIALS)
    small = GalerkinBody(elements, np.ones(block.n_cells), free, states[:0])
    u, found = small.solve(top_force(block))
    assert found.converged
    np.testing.assert_allclose(u, states[-1], atol=1e-5)


def test_a_space_with_the_solution_in_it_finds_it(
    block: TetMesh, states: FloatArray
) -> None:
    elements = make_elements(block, MATERIALS)
    own = block.point_set("loaded")[:5]
    modes = states.copy()
    modes[:, own] = 0.0
    small = GalerkinBody(elements, np.ones(block.n_cells), own, orthonormal(modes))
    u, found = small.solve(top_force(block))
    assert found.converged
    np.testing.assert_allclose(u, states[-1], atol=1e-4)
    assert np.abs(u[block.point_set("fixed")]).max() < 1e-12


def test_modes_that_are_zero_change_nothing(block: TetMesh, states: FloatArray) -> None:
    """Few samples span few modes; K was singular in the others, and u stayed zero."""
    elements = make_elements(block, MATERIALS)
    own = block.point_set("loaded")[:5]
    modes = states.copy()
    modes[:, own] = 0.0
    modes = orthonormal(modes)
    padded = np.concatenate([modes, np.zeros((3, *modes.shape[1:]))])
    few, more = (
        GalerkinBody(elements, np.ones(block.n_cells), own, basis)
        for basis in (modes, padded)
    )
    u, found = more.solve(top_force(block))
    assert found.converged
    np.testing.assert_array_equal(u, few.solve(top_force(block))[0])


def test_stiffness_is_the_derivative_of_force_and_force_of_energy(
    block: TetMesh, states: FloatArray
) -> None:
    own = block.point_set("loaded")[:3]
    modes = states[:3].copy()
    modes[:, own] = 0.0
    weights = np.random.default_rng(0).uniform(0, 2, block.n_cells)
    weights[::2] *= np.isin(block.cells[::2], own).any(axis=1)
    small = GalerkinBody(make_elements(block, MATERIALS), weights, own, modes)
    rng = np.random.default_rng(1)
    x, d = rng.normal(0, 0.05, (2, small.n_unknowns))
    step = 1e-5
    slope = (small.energy(x + step * d) - small.energy(x - step * d)) / (2 * step)
    assert small.force(x) @ d == pytest.approx(slope, rel=1e-6)
    change = (small.force(x + step * d) - small.force(x - step * d)) / (2 * step)
    np.testing.assert_allclose(small.stiffness(x) @ d, change, rtol=1e-5, atol=1e-9)


def test_cells_together_do_the_work_of_the_internal_force(
    block: TetMesh, states: FloatArray
) -> None:
    elements = make_elements(block, MATERIALS)
    modes = orthonormal(states)
    works = cell_works(elements, states[2], modes.astype(np.float32))
    force, _ = internal_force(elements, states[2])
    expected = np.tensordot(modes, force, axes=2)
    np.testing.assert_allclose(works.sum(axis=1), expected, rtol=1e-4, atol=1e-8)


@pytest.mark.parametrize("tolerance", [0.3, 0.03, 0.003])
def test_few_cells_with_weights_do_the_work_of_all(tolerance: float) -> None:
    works = np.random.default_rng(2).normal(1.0, 1.0, (20, 400)).astype(np.float32)
    weights = weigh_cells(works, tolerance)
    total = works.sum(axis=1, dtype=np.float64)
    assert (weights >= 0).all()
    assert 0 < np.count_nonzero(weights) <= 40
    missing = np.linalg.norm(works @ weights - total)
    assert missing <= tolerance * np.linalg.norm(total) * (1 + 1e-5)


def test_hyper_reduction_keeps_the_solution(block: TetMesh, states: FloatArray) -> None:
    elements, modes = make_elements(block, MATERIALS), orthonormal(states)
    works = [cell_works(elements, u, modes.astype(np.float32)) for u in states]
    weights = weigh_cells(np.concatenate(works), 1e-4)
    assert np.count_nonzero(weights) < 0.3 * block.n_cells
    none = np.empty(0, dtype=np.int64)
    u, found = GalerkinBody(elements, weights, none, modes).solve(top_force(block))
    assert found.converged
    linear = RestState(Body(block, MATERIALS)).solve(top_force(block))
    error = np.abs(u - states[-1]).max()
    assert error < 0.1 * np.abs(linear - states[-1]).max()
