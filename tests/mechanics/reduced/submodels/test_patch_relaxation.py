"""The worst patches of a prediction come nearer to equilibrium, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.mesh_topology import points_within
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadPath, NeoHookean, Ogden, SolverOptions, solve
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import strain_energy
from physgnn.mechanics.reduced.submodels import patch_relaxation
from physgnn.mechanics.reduced.submodels.patch_relaxation import (
    K_HOPS,
    PatchRelaxation,
)

NU = 0.45
SOFT, STIFF = NeoHookean(3000.0, NU), NeoHookean(7500.0, NU)
OGDEN = Ogden(coefficients_pa=(900.0,), exponents=(2.0,), bulk_modulus_pa=9000.0)
LAWS = ({0: SOFT, 1: STIFF}, {0: OGDEN, 1: STIFF})


def equilibrium(body: Body) -> tuple[FloatArray, FloatArray]:
    """Return a load, and the displacement under it."""
    mesh = body.mesh
    nodes = mesh.point_set("loaded")
    forces = np.tile([2e-4, 1e-4, -6e-4], (len(nodes), 1))
    path = LoadPath(nodes, forces, np.ones(1))
    options = SolverOptions(tolerance_mm=1e-9)
    found = solve(mesh, path, materials=body.materials, options=options)
    return path.case(0).on_points(mesh.n_points), found.displacement[0]


def inner_point(mesh: TetMesh) -> int:
    """Return the free point nearest to the middle."""
    return int(np.argmin(np.linalg.norm(mesh.points - mesh.points.mean(0), axis=1)))


@pytest.mark.parametrize("materials", LAWS)
def test_equilibrium_stays_as_it_is(block: TetMesh, materials: dict) -> None:
    body = Body(block, materials)
    force, u = equilibrium(body)
    relax = PatchRelaxation(body, np.ones(block.n_points, dtype=bool), 5)
    np.testing.assert_array_equal(relax(force, u), u)


@pytest.mark.parametrize("materials", LAWS)
def test_an_error_within_a_patch_goes_by_its_square(
    block: TetMesh, materials: dict
) -> None:
    """One step of Newton's method: half the error leaves a quarter."""
    body = Body(block, materials)
    force, truth = equilibrium(body)
    relax = PatchRelaxation(body, np.ones(block.n_points, dtype=bool), 1)
    left = []
    for size in (0.1, 0.05):
        wrong = truth.copy()
        wrong[inner_point(block)] += size * np.array([0.8, -0.36, 0.48])
        left.append(np.abs(relax(force, wrong) - truth).max())
        assert left[-1] < 0.2 * size
    assert 3.0 < left[0] / left[1] < 5.0


def test_it_changes_what_is_near_and_lowers_the_energy(block: TetMesh) -> None:
    body = Body(block, LAWS[0])
    force, u = equilibrium(body)
    rng = np.random.default_rng(0)
    guess = u + 0.2 * rng.standard_normal(u.shape)
    guess[body.fixed] = 0.0
    near = np.zeros(block.n_points, dtype=bool)
    near[inner_point(block)] = True
    relaxed = PatchRelaxation(body, near, 3)(force, guess)
    moved = (relaxed != guess).any(axis=1)
    assert moved.any()
    assert not moved[body.fixed].any()
    assert not (moved & ~points_within(block, np.flatnonzero(near), K_HOPS)).any()
    before, after = (
        strain_energy(body.elements, v) - (force * v).sum() for v in (guess, relaxed)
    )
    assert after < before


def test_more_patches_leave_less_energy(block: TetMesh) -> None:
    body = Body(block, LAWS[0])
    force, u = equilibrium(body)
    guess = u + 0.1 * np.random.default_rng(1).standard_normal(u.shape)
    guess[body.fixed] = 0.0
    everywhere = np.ones(block.n_points, dtype=bool)
    energies = []
    for n_patches in (0, 1, 4, 16):
        v = PatchRelaxation(body, everywhere, n_patches)(force, guess)
        energies.append(strain_energy(body.elements, v) - (force * v).sum())
    assert energies == sorted(energies, reverse=True)
    assert energies[0] > energies[-1]


def test_it_turns_with_the_body(block: TetMesh) -> None:
    body = Body(block, LAWS[0])
    force, u = equilibrium(body)
    guess = u + 0.1 * np.random.default_rng(2).standard_normal(u.shape)
    guess[body.fixed] = 0.0
    Q = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    Q *= np.sign(np.linalg.det(Q))
    turned = Body(replace(block, points=block.points @ Q.T), LAWS[0])
    everywhere = np.ones(block.n_points, dtype=bool)
    relaxed = PatchRelaxation(body, everywhere, 4)(force, guess)
    again = PatchRelaxation(turned, everywhere, 4)(force @ Q.T, guess @ Q.T)
    np.testing.assert_allclose(again, relaxed @ Q.T, atol=1e-4)


def test_a_patch_with_an_inverted_cell_is_left_alone(block: TetMesh) -> None:
    body = Body(block, LAWS[0])
    force, u = equilibrium(body)
    u[inner_point(block)] += 20.0
    relax = PatchRelaxation(body, np.ones(block.n_points, dtype=bool), 1)
    np.testing.assert_array_equal(relax(force, u), u)


@pytest.mark.parametrize("k_hops", [2, 1, None])
def test_a_patch_of_many_points_shrinks_or_is_left(
    block: TetMesh, k_hops: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    body = Body(block, LAWS[0])
    force, u = equilibrium(body)
    centre = np.array([inner_point(block)])
    free = np.ones(block.n_points, dtype=bool)
    free[body.fixed] = False
    within = {k: points_within(block, centre, k) & free for k in (1, 2)}
    assert within[1].sum() < within[2].sum()
    most = 0 if k_hops is None else within[k_hops].sum()
    monkeypatch.setattr(patch_relaxation, "MOST_POINTS", most)
    guess = u.copy()
    guess[centre] += 0.1
    near = np.zeros(block.n_points, dtype=bool)
    near[centre] = True
    moved = (PatchRelaxation(body, near, 1)(force, guess) != guess).any(axis=1)
    expected = np.zeros_like(moved) if k_hops is None else within[k_hops]
    np.testing.assert_array_equal(moved, expected)


def test_averaged_elements_are_refused(block: TetMesh) -> None:
    body = Body(block, LAWS[0], element="tet4-averaged")
    with pytest.raises(InputError, match="tet4 elements"):
        PatchRelaxation(body, np.ones(block.n_points, dtype=bool), 1)
