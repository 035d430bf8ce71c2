"""Growth: an energy and its derivatives, no stress in what swells freely."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from element_checks import (
    check_forces_derive_from_energy,
    check_objectivity,
    check_tangent,
    wobble,
)
from meshes import block_mesh
from physgnn.mechanics.elements.growth import grown, growth_force
from physgnn.mechanics.elements.inverted import extrapolated_force
from physgnn.mechanics.elements.second_variation import SecondVariation
from physgnn.mechanics.elements.tet4 import (
    ELEMENTS,
    internal_force,
    make_elements,
    strain_energy,
)
from physgnn.mechanics.materials import TISSUES, MooneyRivlin, NeoHookean

MESH = block_mesh(2, jitter=0.15)
BODIES = [
    {0: NeoHookean(3000.0, 0.49), 1: NeoHookean(7500.0, 0.49)},
    {0: TISSUES["brain-ogden"].material, 1: MooneyRivlin(300.0, 200.0, 2e4)},
]
AT_REST = [make_elements(MESH, body, name) for body in BODIES for name in ELEMENTS]


def ratios(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.8, 1.25, MESH.n_cells)


@pytest.mark.parametrize("at_rest", AT_REST)
@pytest.mark.parametrize("theta", [0.5, 0.97, 1.3, 2.0])
def test_free_swelling_scales_the_body_without_stress_or_energy(at_rest, theta):
    elements = grown(at_rest, np.full(MESH.n_cells, theta))
    turn = Rotation.random(random_state=1).as_matrix()
    u = theta ** (1 / 3) * MESH.points @ turn.T - MESH.points + [1.0, 2.0, 3.0]
    force, inverted = internal_force(elements, u)
    assert inverted == -1
    np.testing.assert_allclose(force, 0, atol=1e-12)
    assert strain_energy(elements, u) == pytest.approx(0, abs=1e-12)
    held, _ = internal_force(elements, np.zeros_like(u))
    assert np.abs(held).max() > 1e-4  # where it may not swell it pushes


@pytest.mark.parametrize("at_rest", AT_REST)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_forces_are_the_derivative_of_energy_and_balance(at_rest, seed):
    check_forces_derive_from_energy(grown(at_rest, ratios(seed)), MESH, seed)


@pytest.mark.parametrize("at_rest", AT_REST)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=10)
def test_rotating_the_deformed_body_rotates_the_forces(at_rest, seed):
    check_objectivity(grown(at_rest, ratios(seed)), MESH, seed)


@pytest.mark.parametrize("at_rest", AT_REST)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=10)
def test_tangent_is_the_derivative_of_force(at_rest, seed):
    none = np.empty(0, dtype=np.int64)
    check_tangent(grown(at_rest, ratios(seed)), MESH, seed, fixed=none)


@pytest.mark.parametrize("at_rest", AT_REST)
def test_the_force_of_growth_is_the_derivative_by_the_ratio(at_rest):
    theta, change, u = ratios(3), ratios(4) - 1.0, wobble(MESH, 5)
    slope = growth_force(at_rest, theta, change, u)
    errors = []
    for h in (1e-2, 5e-3):
        ahead, behind = (
            internal_force(grown(at_rest, theta + s * h * change), u)[0]
            for s in (1.0, -1.0)
        )
        errors.append(np.abs((ahead - behind) / (2 * h) - slope).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)  # second order


def test_what_has_not_grown_is_the_same_to_the_last_bit():
    for at_rest in AT_REST:
        elements = grown(at_rest, np.ones(MESH.n_cells))
        u = wobble(MESH, 2)
        np.testing.assert_array_equal(
            internal_force(elements, u)[0], internal_force(at_rest, u)[0]
        )


def test_stress_is_extrapolated_along_the_line_from_the_grown_cell():
    elements, u = grown(AT_REST[0], ratios(1)), wobble(MESH, 1)
    np.testing.assert_allclose(
        extrapolated_force(elements, u)[0], internal_force(elements, u)[0], atol=1e-15
    )


def test_the_second_variation_knows_growth():
    elements, u, v = grown(AT_REST[0], ratios(1)), wobble(MESH, 1), wobble(MESH, 2)
    h = 1e-3
    ahead, here, behind = (
        internal_force(elements, u + s * h * v)[0] for s in (1.0, 0.0, -1.0)
    )
    np.testing.assert_allclose(
        SecondVariation(elements, u)(v), (ahead - 2 * here + behind) / h**2, atol=1e-7
    )
