"""Every law: derivatives by finite differences, objectivity, closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.elements.tet4 import internal_force, make_elements, strain_energy
from physgnn.mechanics.materials import (
    TISSUES,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    neo_hookean,
    table,
)
from physgnn.mechanics.materials.table import (
    LAW_INDEX,
    material_from_config,
    material_to_config,
)

MATERIALS = [
    NeoHookean(3000.0, 0.49),
    NeoHookean(7500.0, 0.3),
    MooneyRivlin(300.0, 200.0, 20_000.0),
    MooneyRivlin(0.0, 500.0, 1_000.0),
    Ogden((1684.0,), (-4.7,), 41_841.0),
    Ogden((800.0, -150.0, 90.0), (2.0, -2.0, 9.5), 5_000.0),
]
OGDENS = [material for material in MATERIALS if isinstance(material, Ogden)]
CELL = TetMesh(
    [[0.0, 0, 0], [2, 0, 0], [0, 3, 0], [1, 1, 4]], [[0, 1, 2, 3]], np.zeros(1)
)


def energy(material, F):
    law = LAW_INDEX[material.law]
    return table.energy(law, F, np.linalg.det(F), material.constants)


def stress(material, F):
    P = np.empty((3, 3))
    H = np.linalg.inv(F).T
    law = LAW_INDEX[material.law]
    table.stress(law, F, H, np.linalg.det(F), material.constants, P)
    return P


def tangent(material, F):
    A = np.empty((3, 3, 3, 3))
    H = np.linalg.inv(F).T
    law = LAW_INDEX[material.law]
    table.tangent(law, F, H, np.linalg.det(F), material.constants, A)
    return A


def deformation(seed: int, size: float = 0.3) -> np.ndarray:
    """A random F with det F well above zero."""
    rng = np.random.default_rng(seed)
    while True:
        F = np.eye(3) + size * rng.uniform(-1, 1, (3, 3))
        if np.linalg.det(F) > 0.3:
            return F


def central_difference(function, F, h=1e-6):
    """∂ function / ∂F, the components of F last."""
    steps = np.eye(9).reshape(9, 3, 3) * h
    columns = [(function(F + s) - function(F - s)) / (2 * h) for s in steps]
    return np.moveaxis(np.array(columns), 0, -1).reshape(*np.shape(columns[0]), 3, 3)


@pytest.mark.parametrize("material", MATERIALS)
@given(seed=st.integers(0, 10_000))
def test_stress_is_the_derivative_of_energy(material, seed):
    F = deformation(seed)
    expected = central_difference(lambda G: energy(material, G), F)
    scale = np.abs(expected).max() + material.constants.max()
    np.testing.assert_allclose(stress(material, F), expected, atol=1e-7 * scale)


@pytest.mark.parametrize("material", MATERIALS)
@given(seed=st.integers(0, 10_000))
def test_tangent_is_the_derivative_of_stress(material, seed):
    F = deformation(seed)
    expected = central_difference(lambda G: stress(material, G), F)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(tangent(material, F), expected, atol=1e-7 * scale)


@pytest.mark.parametrize("material", MATERIALS)
@given(seed=st.integers(0, 10_000))
def test_objectivity_and_isotropy(material, seed):
    F = deformation(seed)
    Q = Rotation.random(random_state=seed).as_matrix()
    P = stress(material, F)
    scale = np.abs(P).max() + 1e-12
    assert energy(material, Q @ F) == pytest.approx(energy(material, F), rel=1e-9)
    np.testing.assert_allclose(stress(material, Q @ F), Q @ P, atol=1e-10 * scale)
    np.testing.assert_allclose(stress(material, F @ Q.T), P @ Q.T, atol=1e-10 * scale)


@pytest.mark.parametrize("material", MATERIALS)
def test_the_rest_state_is_free_of_stress_and_energy(material):
    F = np.eye(3)
    assert energy(material, F) == 0.0
    np.testing.assert_array_equal(stress(material, F), np.zeros((3, 3)))


@pytest.mark.parametrize("material", MATERIALS)
def test_the_rest_state_is_linear_elasticity(material):
    mu, lam = material.mu, material.lam
    delta = np.eye(3)
    expected = (
        lam * np.einsum("ij,kl->ijkl", delta, delta)
        + mu * np.einsum("ik,jl->ijkl", delta, delta)
        + mu * np.einsum("il,jk->ijkl", delta, delta)
    )
    np.testing.assert_allclose(tangent(material, np.eye(3)), expected, rtol=1e-12)


@given(stretch=st.floats(0.5, 2.0))
def test_neo_hookean_uniaxial_stress_in_closed_form(stretch):
    """Sides free: their stretch t solves μ (t² − 1) + λ ln J = 0, J = s t²."""
    material = NeoHookean(3000.0, 0.45)
    mu, lam = material.mu, material.lam

    def side_stress(t):
        return mu * (t**2 - 1) + lam * np.log(stretch * t**2)

    t = brentq(side_stress, 0.1, 5.0, xtol=1e-14)
    P = stress(material, np.diag([stretch, t, t]))
    axial = (mu * (stretch**2 - 1) + lam * np.log(stretch * t**2)) / stretch
    np.testing.assert_allclose(P, np.diag([axial, 0, 0]), atol=1e-12)


@given(shear=st.floats(-1.5, 1.5))
def test_neo_hookean_simple_shear_in_closed_form(shear):
    """J = 1, so the Cauchy stress is μ (F Fᵀ − I): σ₁₂ = μ γ, σ₁₁ = μ γ²."""
    material = NeoHookean(3000.0, 0.45)
    F = np.eye(3)
    F[0, 1] = shear
    cauchy = stress(material, F) @ F.T
    expected = material.mu * (F @ F.T - np.eye(3))
    np.testing.assert_allclose(cauchy, expected, atol=1e-12)


TERMS = {"coefficients_pa": (800.0, 200.0), "exponents": (2.0, -2.0)}
AS_MOONEY = MooneyRivlin(200.0, 50.0, 20_000.0)
AS_OGDEN = Ogden(**TERMS, bulk_modulus_pa=20_000.0)


def ogden_difference(material: Ogden, one, two):
    """τ₁ − τ₂ = Σ c/m (λ̃₁^m − λ̃₂^m), MPa, of Ogden's law by hand."""
    pairs = zip(material.coefficients_pa, material.exponents, strict=True)
    return 1e-6 * sum(c / m * (one**m - two**m) for c, m in pairs)


@pytest.mark.parametrize("material", OGDENS)
@given(stretch=st.floats(0.6, 1.8))
def test_ogden_uniaxial_stress_in_closed_form(material, stretch):
    """Sides free: k ln J = ⅓ (τ₁ − τ₂), and all of τ₁ − τ₂ is axial."""
    k = 1e-6 * material.bulk_modulus_pa

    def difference(t):
        root = (stretch * t * t) ** (1 / 3)
        return ogden_difference(material, stretch / root, t / root)

    def side_stress(t):
        return k * np.log(stretch * t * t) - difference(t) / 3

    t = brentq(side_stress, 0.3, 2.0, xtol=1e-15)
    P = stress(material, np.diag([stretch, t, t]))
    expected = np.diag([difference(t) / stretch, 0, 0])
    np.testing.assert_allclose(P, expected, atol=1e-10 * (k + np.abs(P).max()))


@pytest.mark.parametrize("material", OGDENS)
@given(shear=st.floats(-1.2, 1.2))
def test_ogden_simple_shear_in_closed_form(material, shear):
    """Stretches s, 1, 1/s with s = γ/2 + √(1 + γ²/4); σ₁₂ = (τ₁ − τ₂)/(s + 1/s)."""
    F = np.eye(3)
    F[0, 1] = shear
    s = shear / 2 + np.sqrt(1 + shear**2 / 4)
    cauchy = stress(material, F) @ F.T
    expected = ogden_difference(material, s, 1 / s) / (s + 1 / s)
    assert cauchy[0, 1] == pytest.approx(expected, rel=1e-9, abs=1e-15)
    assert np.trace(cauchy) == pytest.approx(0.0, abs=1e-12)


@given(shear=st.floats(-1.5, 1.5))
def test_mooney_rivlin_simple_shear_in_closed_form(shear):
    """σ₁₂ = μ γ, σ₁₁ − σ₃₃ = 2 c₁ γ², σ₂₂ − σ₃₃ = −2 c₂ γ²."""
    F = np.eye(3)
    F[0, 1] = shear
    cauchy = stress(AS_MOONEY, F) @ F.T
    c1, c2 = 1e-6 * AS_MOONEY.c1_pa, 1e-6 * AS_MOONEY.c2_pa
    assert cauchy[0, 1] == pytest.approx(2 * (c1 + c2) * shear, rel=1e-10)
    assert cauchy[0, 0] - cauchy[2, 2] == pytest.approx(2 * c1 * shear**2, abs=1e-15)
    assert cauchy[1, 1] - cauchy[2, 2] == pytest.approx(-2 * c2 * shear**2, abs=1e-15)


@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("stretches", [(1.0, 1.0, 1.0), (1.3, 1.3, 0.7), (0.8,) * 3])
def test_ogden_is_exact_where_stretches_meet(stretches, gap):
    """Exponents 2 and −2 make Mooney–Rivlin's law, which knows no principal axes."""
    Q = Rotation.random(random_state=1).as_matrix()
    R = Rotation.random(random_state=2).as_matrix()
    F = Q @ np.diag(np.array(stretches) * [1 + gap, 1, 1 - gap]) @ R
    assert energy(AS_OGDEN, F) == pytest.approx(energy(AS_MOONEY, F), rel=1e-9)
    for quantity in (stress, tangent):
        expected = quantity(AS_MOONEY, F)
        np.testing.assert_allclose(
            quantity(AS_OGDEN, F), expected, atol=1e-12 * np.abs(expected).max() + 1e-17
        )


@given(seed=st.integers(0, 10_000))
def test_ogden_contains_mooney_rivlin(seed):
    F = deformation(seed)
    expected = tangent(AS_MOONEY, F)
    np.testing.assert_allclose(
        tangent(AS_OGDEN, F), expected, atol=1e-11 * np.abs(expected).max()
    )


@pytest.mark.parametrize("name", TISSUES)
def test_every_tissue_names_its_source_and_is_stable(name):
    tissue = TISSUES[name]
    assert len(tissue.source) > 20
    assert tissue.material.mu > 0
    assert tissue.material.lam + 2 * tissue.material.mu / 3 > 0
    assert material_from_config(material_to_config(tissue.material)) == tissue.material


@pytest.mark.parametrize("material", MATERIALS)
def test_config_round_trip(material):
    assert material_from_config(material_to_config(material)) == material


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"law": "jelly"}, "unknown material law 'jelly'"),
        ({"youngs_modulus_pa": 3000.0}, "takes youngs_modulus_pa, poissons_ratio"),
        (
            {"youngs_modulus_pa": 3000.0, "poissons_ratio": 0.4, "colour": 1},
            "got youngs_modulus_pa, poissons_ratio, colour",
        ),
        ({"youngs_modulus_pa": -1.0, "poissons_ratio": 0.4}, "must be > 0"),
        ({"youngs_modulus_pa": 3000.0, "poissons_ratio": 0.5}, "poissons_ratio"),
        (
            {"law": "mooney-rivlin", "c1_pa": 0, "c2_pa": 0, "bulk_modulus_pa": 1},
            "c1_pa \\+ c2_pa must be > 0",
        ),
        (
            {"law": "mooney-rivlin", "c1_pa": -1, "c2_pa": 9, "bulk_modulus_pa": 1},
            "must be ≥ 0",
        ),
        ({"law": "ogden", **TERMS, "bulk_modulus_pa": 0.0}, "bulk_modulus_pa"),
        (
            {"law": "ogden", **TERMS, "exponents": (2.0,), "bulk_modulus_pa": 1},
            "1 to 3 pairs",
        ),
        (
            {"law": "ogden", **TERMS, "exponents": (2.0, 0.0), "bulk_modulus_pa": 1},
            "not 0",
        ),
    ],
)
def test_a_wrong_material_is_refused(values, message):
    with pytest.raises(InputError, match=message):
        material_from_config(values)


# An example of every row, and its energy written down once more without the table.
def _neo_hookean(m, F):
    J = np.linalg.det(F)
    return m.mu / 2 * ((F**2).sum() - 3) - m.mu * np.log(J) + m.lam / 2 * np.log(J) ** 2


def _mooney_rivlin(m, F):
    J, C = np.linalg.det(F), F.T @ F
    first, second = np.trace(C), (np.trace(C) ** 2 - np.trace(C @ C)) / 2
    k, c1, c2 = 1e-6 * np.array([m.bulk_modulus_pa, m.c1_pa, m.c2_pa])
    return (
        c1 * (first * J ** (-2 / 3) - 3)
        + c2 * (second * J ** (-4 / 3) - 3)
        + k / 2 * np.log(J) ** 2
    )


def _ogden(m, F):
    J = np.linalg.det(F)
    stretches = np.linalg.svd(F, compute_uv=False) * J ** (-1 / 3)
    terms = zip(m.coefficients_pa, m.exponents, strict=True)
    return 1e-6 * (
        sum(c / n**2 * ((stretches**n).sum() - 3) for c, n in terms)
        + m.bulk_modulus_pa / 2 * np.log(J) ** 2
    )


OWN_ENERGY = {
    NeoHookean: _neo_hookean,
    MooneyRivlin: _mooney_rivlin,
    Ogden: _ogden,
}


@pytest.mark.parametrize("law", table.LAWS.values(), ids=list(table.LAWS))
def test_every_row_computes_its_own_law(law):
    """A row without a branch, or with another row's, was computed as Ogden before."""
    examples = [material for material in MATERIALS if type(material) is law]
    assert examples and law in OWN_ENERGY, f"add {law.__name__} to these tests"
    for material in examples:
        for seed in range(20):
            F = deformation(seed)
            expected = OWN_ENERGY[law](material, F)
            assert energy(material, F) == pytest.approx(expected, rel=1e-10)
            assembled = strain_energy(make_elements(CELL, {0: material}), stretch(F))
            assert assembled == pytest.approx(expected * CELL.cell_volumes[0])


def stretch(F):
    """The displacement that deforms the one cell by F."""
    return CELL.points @ (F - np.eye(3)).T


def test_a_law_that_is_in_no_table_is_refused():
    class Unknown(NeoHookean):
        law = "unknown"

    with pytest.raises(InputError, match="'unknown' is not in the table"):
        make_elements(CELL, {0: Unknown(3000.0, 0.3)})


@pytest.mark.parametrize("kernel", ["energy", "stress", "tangent"])
def test_a_row_without_a_branch_is_an_error(kernel):
    missing = len(table.LAWS)
    F, c = np.eye(3), np.ones(8)
    arguments = {
        "energy": (missing, F, 1.0, c),
        "stress": (missing, F, F, 1.0, c, np.empty((3, 3))),
        "tangent": (missing, F, F, 1.0, c, np.empty((3, 3, 3, 3))),
    }[kernel]
    with pytest.raises(ValueError, match="has no branch"):
        getattr(table, kernel)(*arguments)


def test_the_kernels_refuse_a_law_without_a_branch():
    """As one cell among others, whose laws have branches."""
    elements = make_elements(CELL, {0: MATERIALS[0]})
    elements = replace(elements, law=np.array([len(table.LAWS)]))
    rest = np.zeros_like(CELL.points)
    for kernel in (strain_energy, internal_force):
        with pytest.raises(ValueError, match="has no branch"):
            kernel(elements, rest)


def test_the_closed_stiffness_of_a_neo_hookean_cell_is_its_tangents() -> None:
    rng = np.random.default_rng(4)
    F = np.eye(3) + 0.3 * rng.standard_normal((3, 3))
    J, H = np.linalg.det(F), np.linalg.inv(F).T
    assert J > 0
    gradient, constants = rng.standard_normal((4, 3)), np.array([2.0, 0.3])
    A, K = np.empty((3, 3, 3, 3)), np.zeros((4, 4, 3, 3))
    neo_hookean.tangent(F, H, J, constants, A)
    neo_hookean.stiffness(gradient, 1.7, H, J, constants, np.empty((4, 3)), K)
    expected = 1.7 * np.einsum("aJ,iJkL,bL->abik", gradient, A, gradient)
    for a in range(4):
        np.testing.assert_allclose(K[a, a:], expected[a, a:], atol=1e-12)
        assert (K[a, :a] == 0).all()
