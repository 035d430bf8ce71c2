"""Rates against a known solution, locking and its cure: the benchmark, asserted."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from physgnn.mechanics import NeoHookean, Solver
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.full_newton import Newton

FILE = Path(__file__).parents[2] / "benchmarks" / "elements.py"
SPEC = importlib.util.spec_from_file_location("benchmark_elements", FILE)
elements = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(elements)


def rates(nu, element, sizes=(5, 10)):
    coarse, fine = (elements.manufactured_errors(n, nu, element) for n in sizes)
    return np.log(np.divide(coarse, fine)) / np.log(sizes[1] / sizes[0])


def test_the_known_solution_keeps_its_volume_and_its_gradient_is_right():
    x = np.random.default_rng(0).uniform(0, 10, (50, 3))
    _, gradient = elements.wave(x)
    np.testing.assert_allclose(np.linalg.det(np.eye(3) + gradient), 1, atol=1e-14)
    for axis, step in enumerate(1e-6 * np.eye(3)):
        slope = (elements.wave(x + step)[0] - elements.wave(x - step)[0]) / 2e-6
        np.testing.assert_allclose(gradient[..., axis], slope, atol=1e-8)


@pytest.mark.parametrize("element", ["tet4", "tet4-averaged"])
def test_errors_fall_with_h_squared_and_slopes_with_h(element):
    l2, h1 = rates(0.3, element)
    assert 1.75 < l2 < 2.2
    assert 0.9 < h1 < 1.1


def test_near_incompressibility_only_averaged_tetrahedra_keep_their_rate():
    assert rates(0.4999, "tet4")[0] < 1.2
    l2, h1 = rates(0.4999, "tet4-averaged")
    assert l2 > 1.75
    assert h1 > 0.9


def test_a_squeezed_block_locks_and_averaging_unlocks_it():
    """Four cells a side averaged beat eight that lock."""
    locked = elements.squeezed_block_force(8, 0.499, "tet4")
    cured, finer = (
        elements.squeezed_block_force(n, 0.499, "tet4-averaged") for n in (4, 8)
    )
    assert locked > 2 * finer
    assert finer < cured < 1.3 * finer


def test_cooks_membrane_rises_with_averaging_and_hardly_without():
    locked, cured, moderate = (
        elements.cook_tip(8, nu, element)
        for nu, element in (
            (0.499, "tet4"),
            (0.499, "tet4-averaged"),
            (0.3, "tet4-averaged"),
        )
    )
    assert cured > 2.5 * locked
    assert cured == pytest.approx(moderate, rel=0.1)


def test_strong_bending_near_incompressibility_is_followed_to_its_end():
    """Steps overshoot by far; not shortened, they took 192 factorisations."""
    mesh, path = elements.cook_path(8, 0.02)
    material, element = {0: NeoHookean(3000.0, 0.4999)}, "tet4-averaged"
    body = Body(mesh, material, element=element)
    solution = Solver(body).solve(path)
    assert solution.converged, solution.message
    assert solution.counts["factorisations"] < 100
    assert np.linalg.norm(solution.displacement[-1], axis=1).max() > 0.3 * 48
    exact = Newton(body)
    assert exact.distance(path, solution.displacement[-1]) < 1e-3
