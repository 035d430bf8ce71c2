"""The second variation against a difference of the internal force itself."""

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.mechanics.elements.second_variation import SecondVariation
from physgnn.mechanics.elements.tet4 import ELEMENTS, internal_force, make_elements
from physgnn.mechanics.materials import MooneyRivlin, NeoHookean, Ogden

MESH = block_mesh(2, jitter=0.15)
LAWS = [
    NeoHookean(3000.0, 0.49),
    MooneyRivlin(c1_pa=300.0, c2_pa=200.0, bulk_modulus_pa=5e4),
    Ogden(coefficients_pa=(800.0,), exponents=(-4.7,), bulk_modulus_pa=5e4),
]


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.law)
@pytest.mark.parametrize("seed", range(3))
def test_it_is_the_second_derivative_of_the_internal_force(law, element, seed):
    elements = make_elements(MESH, {0: law, 1: NeoHookean(7500.0, 0.4)}, element)
    rng = np.random.default_rng(seed)
    u, v = 0.3 * rng.uniform(-1, 1, (2, *MESH.points.shape))
    h = 1e-3
    ahead, here, behind = (
        internal_force(elements, u + s * h * v)[0] for s in (1, 0, -1)
    )
    expected = (ahead - 2 * here + behind) / h**2
    found = SecondVariation(elements, u)(v)
    np.testing.assert_allclose(found, expected, atol=2e-4 * np.abs(expected).max())


def test_it_scales_with_the_square_of_the_direction():
    elements = make_elements(MESH, {0: LAWS[0], 1: LAWS[0]})
    u, v = 0.3 * np.random.default_rng(0).uniform(-1, 1, (2, *MESH.points.shape))
    once, twice = (SecondVariation(elements, u)(s * v) for s in (1.0, 2.0))
    np.testing.assert_allclose(twice, 4 * once, rtol=1e-10)
