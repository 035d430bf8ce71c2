"""Stress in homogeneous tests: derivative of the energy, closed forms, the solver."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import block_mesh
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solver import Solver, SolverOptions
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement
from physgnn.mechanics.materials import TISSUES, MooneyRivlin, NeoHookean, Ogden, table
from physgnn.mechanics.materials.homogeneous import (
    free_width,
    shear_stress,
    uniaxial_stress,
)
from physgnn.mechanics.materials.table import law_index

MATERIALS = [
    NeoHookean(3000.0, 0.49),
    MooneyRivlin(300.0, 200.0, 20_000.0),
    TISSUES["corona-radiata"].material,
    Ogden((800.0, 150.0), (-12.0, 9.5), 15_000.0),
]
PA = 1e6


def energy_pa(material, F) -> float:
    F = np.ascontiguousarray(F)
    law, constants = law_index(material), material.constants
    return PA * table.energy(law, F, np.linalg.det(F), constants)


def stretched(material, stretch: float) -> np.ndarray:
    (width,) = free_width(material, np.array([stretch]))
    return np.diag([stretch, width, width])


@pytest.mark.parametrize("material", MATERIALS)
@given(stretch=st.floats(0.75, 1.3))
def test_uniaxial_stress_is_the_derivative_of_the_energy(material, stretch) -> None:
    """Of the energy of free sides: its derivative by the width is zero."""
    h = 1e-5
    ends = [energy_pa(material, stretched(material, stretch + s)) for s in (h, -h)]
    (stress,) = uniaxial_stress(material, np.array([stretch]))
    assert np.isclose((ends[0] - ends[1]) / (2 * h), stress, rtol=1e-6, atol=1e-3)
    F = stretched(material, stretch)
    wider, narrower = F.copy(), F.copy()
    wider[1, 1] += h
    narrower[1, 1] -= h
    side = (energy_pa(material, wider) - energy_pa(material, narrower)) / (2 * h)
    assert abs(side) < 1e-3


@pytest.mark.parametrize("material", MATERIALS)
@given(amount=st.floats(0.0, 0.6))
def test_shear_stress_is_the_derivative_of_the_energy(material, amount) -> None:
    h = 1e-5
    ends = [np.eye(3), np.eye(3)]
    ends[0][0, 1], ends[1][0, 1] = amount + h, amount - h
    difference = energy_pa(material, ends[0]) - energy_pa(material, ends[1])
    (stress,) = shear_stress(material, np.array([amount]))
    assert np.isclose(difference / (2 * h), stress, rtol=1e-6, atol=1e-3)


@given(
    mu=st.floats(100.0, 5000.0),
    alpha=st.floats(-30.0, 30.0).filter(lambda a: abs(a) > 0.5),
)
def test_ogden_incompressible(mu, alpha) -> None:
    """P = 2μ/α (λ^(α−1) − λ^(−α/2−1)), and its like in shear (Budday et al. 2017)."""
    material = Ogden((2 * mu,), (alpha,), 1e8 * mu)
    stretch = np.linspace(0.85, 1.15, 7)
    expected = 2 * mu / alpha * (stretch ** (alpha - 1) - stretch ** (-alpha / 2 - 1))
    found = uniaxial_stress(material, stretch)
    assert np.allclose(found, expected, rtol=1e-5, atol=1e-4 * mu)
    amount = np.linspace(0.0, 0.3, 5)
    principal = amount / 2 + np.sqrt(1 + amount**2 / 4)
    expected = (principal**alpha - principal**-alpha) / (principal + 1 / principal)
    found = shear_stress(material, amount)
    assert np.allclose(found, 2 * mu / alpha * expected, rtol=1e-9, atol=1e-9 * mu)


def test_neo_hookean_small_strain() -> None:
    """Young's modulus, Poisson's ratio, and shear modulus at rest."""
    material, h = NeoHookean(3000.0, 0.45), 1e-7
    (stress,) = uniaxial_stress(material, np.array([1 + h]))
    (width,) = free_width(material, np.array([1 + h]))
    assert np.isclose(stress / h, 3000.0, rtol=1e-5)
    assert np.isclose((1 - width) / h, 0.45, rtol=1e-5)
    (stress,) = shear_stress(material, np.array([0.3]))
    assert np.isclose(stress, 3000.0 / 2.9 * 0.3)


@pytest.mark.parametrize("name", ["cortex", "corona-radiata", "brain"])
@pytest.mark.parametrize("stretch", [0.9, 1.1])
def test_the_solver_gives_the_uniaxial_curve(name, stretch) -> None:
    """The ends go where free sides let them; the solver finds the middle and force."""
    # Nothing is fixed: the load alone holds the cube.
    material, mesh = TISSUES[name].material, block_mesh(2)
    z = mesh.points[:, 2]
    ends = np.flatnonzero((z == 0) | (z == 10))
    (width,) = free_width(material, np.array([stretch]))
    F = np.diag([width, width, stretch])
    affine = mesh.points @ (F - np.eye(3))
    path = LoadPath.of(np.array([1.0]), PrescribedDisplacement(ends, affine[ends]))
    body = Body(mesh, dict.fromkeys((0, 1), material), np.empty(0, dtype=np.int64))
    solution = Solver(body, options=SolverOptions(tolerance_mm=1e-9)).solve(path)
    assert solution.converged
    u = solution.displacement[0]
    assert np.allclose(u, affine, atol=1e-8)
    force = internal_force(body.elements, u)[0][np.flatnonzero(z == 10), 2].sum()
    (expected,) = uniaxial_stress(material, np.array([stretch]))
    assert np.isclose(PA * force / 100.0, expected, rtol=1e-6)
