"""Response modes against the whole flexibility of a block."""

from collections.abc import Callable

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.reduced.expansions import response_modes as module
from physgnn.mechanics.reduced.expansions.response_modes import softest_responses

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}


@pytest.fixture
def solve(block: TetMesh) -> Callable[[np.ndarray], np.ndarray]:
    rest = RestState(Body(block, MATERIALS))
    return lambda forces: np.stack([rest.solve(force) for force in forces])


def forces_on(block: TetMesh, nodes: np.ndarray, n: int) -> np.ndarray:
    forces = np.zeros((n, block.n_points, 3))
    forces[:, nodes] = np.random.default_rng(0).normal(size=(n, len(nodes), 3)) * 1e-2
    return forces


@pytest.mark.parametrize("dense", [0, 100])
def test_they_are_orthonormal_in_energy_and_softest_first(
    block: TetMesh, solve: Callable, dense: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "DENSE", dense)
    nodes, n = block.point_set("loaded"), 6
    modes = softest_responses(solve, nodes, block.n_points, n)
    elements, step = Body(block, MATERIALS).elements, 1e-5 / np.abs(modes).max()
    pushed = [
        (
            internal_force(elements, step * mode)[0]
            - internal_force(elements, -step * mode)[0]
        )
        / (2 * step)
        for mode in modes
    ]
    products = np.einsum("mni,kni->mk", modes, np.stack(pushed))
    np.testing.assert_allclose(products, np.eye(n), atol=1e-3)
    assert (modes[:, block.point_set("fixed")] == 0).all()
    # λ = v·G v is the work of a force of one N: what moves most comes first
    softness = (modes[:, nodes] ** 2).sum(axis=(1, 2))
    assert (np.diff(softness) <= 1e-6 * softness[0]).all()


def test_all_of_them_give_the_linear_solution(block: TetMesh, solve: Callable) -> None:
    nodes = block.point_set("loaded")[:3]
    modes = softest_responses(solve, nodes, block.n_points, 12)
    assert (modes[9:] == 0).all()
    force = forces_on(block, nodes, 1)
    shares = (modes * force).sum(axis=(1, 2))
    found = np.tensordot(shares, modes, axes=1)
    expected = solve(force)[0]
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_error_in_energy_falls_with_their_number(
    block: TetMesh, solve: Callable
) -> None:
    """And no other shapes of as many forces do better: that is what the first are."""
    nodes = block.point_set("loaded")
    forces = forces_on(block, nodes, 20)
    exact = solve(forces)
    work = (forces * exact).sum()
    captured = []
    for n in (2, 4, 8, 16):
        modes = softest_responses(solve, nodes, block.n_points, n)
        shares = np.einsum("mni,kni->km", modes, forces)
        captured.append((shares**2).sum() / work)
    assert (np.diff(captured) > 0).all()
    assert captured[-1] < 1 + 1e-9


@pytest.mark.parametrize("dense", [0, 100])
@pytest.mark.parametrize("noise", [1e-5, 1e-2])
def test_rounding_leaves_fewer_and_no_nonsense(
    block: TetMesh,
    solve: Callable,
    dense: int,
    noise: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """K⁻¹ comes in single precision, and nearly incompressible bodies cost digits."""
    monkeypatch.setattr(module, "DENSE", dense)
    rng = np.random.default_rng(0)

    def rounded(forces: np.ndarray) -> np.ndarray:
        exact = solve(forces)
        return exact + noise * np.abs(exact).max() * rng.standard_normal(exact.shape)

    nodes = block.point_set("loaded")
    modes = softest_responses(rounded, nodes, block.n_points, 12)
    assert np.isfinite(modes).all()
    forces = forces_on(block, nodes, 5)
    shares = np.einsum("mni,kni->km", modes, forces)
    work = (forces * solve(forces)).sum()
    assert (shares**2).sum() < (1 + 50 * noise) * work


def test_without_points_to_load_there_are_none(block: TetMesh, solve: Callable) -> None:
    none = np.array([], dtype=np.int64)
    assert (softest_responses(solve, none, block.n_points, 3) == 0).all()
