"""Forces without elements: derivative of energy, balance, rigid motion, masses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from element_checks import wobble
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.growth import grown
from physgnn.mechanics.elements.tet4 import Elements, make_elements
from physgnn.mechanics.materials import TISSUES, MooneyRivlin, NeoHookean
from physgnn.mechanics.meshless.approximation import Approximation, make_approximation
from physgnn.mechanics.meshless.integrated_forces import (
    internal_force,
    scaled_mass,
    strain_energy,
)
from physgnn.mechanics.meshless.options import MeshlessOptions

MATERIALS = (
    {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.45)},
    {0: TISSUES["brain-ogden"].material, 1: MooneyRivlin(300.0, 200.0, 2e4)},
)


@pytest.fixture(params=MATERIALS, ids=["neo-hookean", "two-laws"])
def elements(request: pytest.FixtureRequest, block: TetMesh) -> Elements:
    return make_elements(block, request.param)


@pytest.mark.parametrize("swells", [False, True])
def test_forces_derive_from_energy(
    block: TetMesh, approximation: Approximation, elements: Elements, swells: bool
) -> None:
    at = approximation.integration
    if swells:
        elements = grown(elements, np.linspace(0.8, 1.3, block.n_cells))
    u, v, h = wobble(block, 0), wobble(block, 1), 1e-5
    force, inverted = internal_force(at, elements, u)
    ahead, behind = (strain_energy(at, elements, u + s * h * v) for s in (1, -1))
    assert inverted == -1
    assert (force * v).sum() == pytest.approx((ahead - behind) / (2 * h), rel=1e-5)


def test_forces_and_moments_balance(
    block: TetMesh, approximation: Approximation, elements: Elements
) -> None:
    u = wobble(block, 2)
    force, _ = internal_force(approximation.integration, elements, u)
    assert np.abs(force).max() > 1e-3
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-12)
    moment = np.cross(block.points + u, force).sum(axis=0)
    np.testing.assert_allclose(moment, 0, atol=1e-11)


def test_rigid_motion_takes_no_force(
    block: TetMesh, approximation: Approximation, elements: Elements
) -> None:
    Q = Rotation.from_rotvec([0.4, -0.9, 1.3]).as_matrix()
    u = block.points @ Q.T - block.points + [3.0, -2.0, 7.0]
    force, _ = internal_force(approximation.integration, elements, u)
    np.testing.assert_allclose(force, 0, atol=1e-10)
    turned = (block.points + wobble(block, 3)) @ Q.T - block.points
    expected, _ = internal_force(approximation.integration, elements, wobble(block, 3))
    force, _ = internal_force(approximation.integration, elements, turned)
    np.testing.assert_allclose(force, expected @ Q.T, atol=1e-11)


@pytest.mark.parametrize("points_per_cell", [1, 4])
def test_an_affine_deformation_has_the_energy_of_its_volume(
    block: TetMesh, points_per_cell: int
) -> None:
    law = NeoHookean(3000.0, 0.49)
    elements = make_elements(block, {0: law, 1: law})
    A = np.array([[0.1, 0.05, 0], [0, -0.08, 0.02], [0.02, 0, 0.06]])
    options = MeshlessOptions(points_per_cell=points_per_cell)
    at = make_approximation(block, options).integration
    F = np.eye(3) + A
    ln_j = np.log(np.linalg.det(F))
    density = law.mu / 2 * ((F**2).sum() - 3) - law.mu * ln_j + law.lam / 2 * ln_j**2
    found = strain_energy(at, elements, block.points @ A.T)
    assert found == pytest.approx(1000.0 * density, rel=1e-8)


def test_an_inverted_cell_is_named(
    block: TetMesh, approximation: Approximation, elements: Elements
) -> None:
    mirrored = block.points * [-2.0, 0.0, 0.0]
    at = approximation.integration
    assert internal_force(at, elements, mirrored)[1] == 0
    assert strain_energy(at, elements, mirrored) == np.inf


def test_masses_bound_every_frequency(
    block: TetMesh, approximation: Approximation
) -> None:
    law = NeoHookean(3000.0, 0.49)
    elements, at = make_elements(block, {0: law, 1: law}), approximation.integration
    stiffness = block.cell_volumes * (3 * law.lam + 2 * law.mu)
    mass = np.repeat(scaled_mass(at, block.n_points, stiffness), 3)
    h, n = 1e-6, 3 * block.n_points
    columns = [
        internal_force(at, elements, h * unit.reshape(-1, 3))[0].ravel() / h
        for unit in np.eye(n)
    ]
    frequencies = np.linalg.eigvalsh(np.array(columns) / np.sqrt(np.outer(mass, mass)))
    assert 0.01 < frequencies.max() <= 1.0
