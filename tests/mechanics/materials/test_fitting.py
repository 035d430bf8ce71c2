"""Fits find the parameters that made the curves, and what papers found in brain."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.io.stress_curves import read_stress_curves
from physgnn.mechanics.materials import (
    TISSUES,
    Material,
    MooneyRivlin,
    NeoHookean,
    Ogden,
)
from physgnn.mechanics.materials.fitted_laws import (
    bulk_modulus_by_ratio,
    constant_bulk_modulus,
)
from physgnn.mechanics.materials.fitting import fit_law
from physgnn.mechanics.materials.stress_curves import KINDS, StressCurve

AMOUNTS = {
    "tension": np.linspace(1.0, 1.2, 9),
    "compression": np.linspace(1.0, 0.8, 9),
    "shear": np.linspace(0.0, 0.3, 9),
}
modulus = st.floats(100.0, 5000.0)
ratio = st.floats(0.3, 0.4999)


def curves_of(material: Material, kinds=tuple(KINDS)) -> list[StressCurve]:
    return [
        StressCurve(kind, AMOUNTS[kind], KINDS[kind](material, AMOUNTS[kind]))
        for kind in kinds
    ]


def ogden(c: tuple[float, ...], m: tuple[float, ...], nu: float) -> Ogden:
    return Ogden(c, m, bulk_modulus_by_ratio(nu)(sum(c) / 2))


@settings(max_examples=15)
@given(modulus, ratio)
def test_neo_hookean_is_recovered(e, nu) -> None:
    fit = fit_law(
        curves_of(NeoHookean(e, nu)), "neo-hookean", bulk=bulk_modulus_by_ratio(nu)
    )
    assert isinstance(fit.material, NeoHookean)
    assert np.isclose(fit.material.youngs_modulus_pa, e, rtol=1e-5)
    assert np.isclose(fit.material.poissons_ratio, nu, rtol=1e-10)
    assert max(fit.errors.values()) < 1e-5


@settings(max_examples=15)
@given(modulus, modulus, st.floats(1e4, 1e7))
def test_mooney_rivlin_is_recovered(c1, c2, kappa) -> None:
    material = MooneyRivlin(c1, c2, kappa)
    bulk = constant_bulk_modulus(kappa)
    fit = fit_law(curves_of(material), "mooney-rivlin", bulk=bulk)
    assert isinstance(fit.material, MooneyRivlin)
    assert np.isclose(fit.material.c1_pa, c1, rtol=1e-4)
    assert np.isclose(fit.material.c2_pa, c2, rtol=1e-4)


@settings(max_examples=15)
@given(modulus, st.floats(3.0, 35.0).flatmap(lambda m: st.sampled_from([m, -m])), ratio)
def test_ogden_is_recovered(c, m, nu) -> None:
    material = ogden((c,), (m,), nu)
    fit = fit_law(curves_of(material), "ogden", bulk=bulk_modulus_by_ratio(nu))
    assert isinstance(fit.material, Ogden)
    assert np.allclose(fit.material.coefficients_pa, (c,), rtol=1e-4)
    assert np.allclose(fit.material.exponents, (m,), rtol=1e-4)
    assert fit.notes == ()


@settings(max_examples=6)
@given(modulus, modulus, st.floats(-25.0, -8.0), st.floats(6.0, 20.0))
def test_two_terms_of_ogden_follow_their_curves(c1, c2, m1, m2) -> None:
    """Parameters of two terms stand in for each other; the stress is determined."""
    material = ogden((c1, c2), (m1, m2), 0.49)
    bulk = bulk_modulus_by_ratio(0.49)
    fit = fit_law(curves_of(material), "ogden", bulk=bulk, terms=2)
    assert max(fit.errors.values()) < 1e-3
    assert np.isclose(fit.material.mu, material.mu, rtol=1e-2)


def test_one_curve_will_do() -> None:
    material = ogden((1000.0,), (-12.0,), 0.49)
    bulk = bulk_modulus_by_ratio(0.49)
    fit = fit_law(curves_of(material, ("compression",)), "ogden", bulk=bulk)
    assert list(fit.errors) == ["compression"]
    assert fit.errors["compression"] < 1e-5


def test_a_second_term_that_is_not_there_is_reported() -> None:
    bulk = bulk_modulus_by_ratio(0.49)
    curves = curves_of(ogden((1000.0,), (-12.0,), 0.49))
    fit = fit_law(curves, "ogden", bulk=bulk, terms=2)
    assert max(fit.errors.values()) < 1e-4
    assert "take --terms 1" in " ".join(fit.notes)


def test_an_exponent_that_the_curves_do_not_determine_is_reported() -> None:
    """Stress that jumps up at the end asks for an exponent without end."""
    amount = np.array([0.0, 0.05, 0.1, 0.15, 0.2])
    curve = StressCurve("shear", amount, np.array([0, 1e-3, 2e-3, 3e-3, 900.0]))
    fit = fit_law([curve], "ogden", bulk=bulk_modulus_by_ratio(0.49))
    assert "where the search ends" in fit.notes[0]


def test_a_bulk_modulus_too_small_is_reported() -> None:
    curves = curves_of(NeoHookean(3000.0, 0.49), ("shear",))
    fit = fit_law(curves, "mooney-rivlin", bulk=constant_bulk_modulus(1.0))
    assert "Poisson's ratio is negative" in fit.notes[0]


@pytest.mark.parametrize("law", ["neo-hookean", "mooney-rivlin", "ogden"])
@pytest.mark.parametrize("size", [1e-2, 1e5])
@pytest.mark.parametrize("stretch", [1.001, 3.0, 10.0])
def test_odd_curves_are_fitted_or_refused(law, size, stretch) -> None:
    """With no warning from NumPy, and no error but our own."""
    amount = np.linspace(1.0, stretch, 5)
    curve = StressCurve("tension", amount, size * (amount - 1))
    try:
        fit = fit_law([curve], law, bulk=bulk_modulus_by_ratio(0.49))
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert np.isfinite(fit.errors["tension"])


@pytest.mark.parametrize(
    ("law", "terms", "message"),
    [
        ("jelly", 1, "no fit for law 'jelly'"),
        ("ogden", 3, r"must be in 1…2 \(got 3\)"),
        ("mooney-rivlin", 2, r"must be in 1…1 \(got 2\)"),
        ("ogden", 2, r"4 parameters need more points beside rest \(got 3\)"),
    ],
)
def test_refusals(law, terms, message) -> None:
    curve = StressCurve("shear", np.array([0, 0.1, 0.2, 0.3]), np.array([0, 1, 2, 3]))
    with pytest.raises(InputError, match=message):
        fit_law([curve], law, bulk=bulk_modulus_by_ratio(0.49), terms=terms)


@pytest.mark.parametrize("value", [0.5, -0.1, np.nan])
def test_ratios_that_cannot_be(value) -> None:
    with pytest.raises(InputError, match=r"must be in \[0, 0\.5\)"):
        bulk_modulus_by_ratio(value)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_bulk_moduli_that_cannot_be(value) -> None:
    with pytest.raises(InputError, match="must be > 0 Pa"):
        constant_bulk_modulus(value)


@pytest.fixture(params=["corona_radiata", "cortex"])
def measured(request: pytest.FixtureRequest, shared: Path) -> tuple[str, list]:
    """Human brain, Budday et al. 2017: a name and its curves."""
    file = shared / "real" / f"budday2017_{request.param}.dat"
    if not file.is_file():
        pytest.skip(f"no curves of brain tissue at {file}")
    return request.param, read_stress_curves(file)


INCOMPRESSIBLE = {  # μ in Pa, α, errors in tension, compression and shear
    "corona_radiata": (630.0, -24.0, (0.05, 0.13, 0.11)),
    "cortex": (1460.0, -19.0, (0.15, 0.04, 0.10)),
}


def test_brain_as_others_fit_it(measured) -> None:
    name, curves = measured
    mu, alpha, errors = INCOMPRESSIBLE[name]
    fit = fit_law(curves, "ogden", bulk=bulk_modulus_by_ratio(0.49999))
    assert isinstance(fit.material, Ogden)
    assert np.isclose(1e6 * fit.material.mu, mu, rtol=0.01)
    assert np.isclose(fit.material.exponents[0], alpha, atol=0.2)
    assert np.allclose(list(fit.errors.values()), errors, atol=0.01)


def test_the_tissues_are_these_fits_and_name_their_errors(measured) -> None:
    name, curves = measured
    tissue = TISSUES[name.replace("_", "-")]
    fit = fit_law(curves, "ogden", bulk=bulk_modulus_by_ratio(0.49))
    ours, theirs = tissue.material, fit.material
    assert isinstance(ours, Ogden) and isinstance(theirs, Ogden)
    assert np.isclose(ours.mu, theirs.mu, rtol=1e-3)
    assert np.isclose(ours.exponents[0], theirs.exponents[0], rtol=1e-3)
    assert np.isclose(ours.bulk_modulus_pa, theirs.bulk_modulus_pa, rtol=1e-3)
    percent = [f"{100 * curve.relative_error(ours):.0f}" for curve in curves]
    assert f"RMS stress {' / '.join(percent)} %" in tissue.source


def test_the_default_law_is_far_off(measured) -> None:
    name, curves = measured
    expected = {
        "corona_radiata": (0.91, 0.48, 0.22),
        "cortex": (0.23, 0.66, 0.54),
    }[name]
    stiff = NeoHookean(3000.0, 0.49)
    errors = [curve.relative_error(stiff) for curve in curves]
    assert np.allclose(errors, expected, atol=0.02)


def test_the_page_has_the_error_of_every_tissue(measured) -> None:
    name, curves = measured
    page = Path(__file__).parents[3] / "docs" / "results" / "tissue.md"
    rows = [line.split("|") for line in page.read_text("utf-8").splitlines()]
    column = {"cortex": 2, "corona_radiata": 3}[name]
    shown = {
        row[1].strip(" `"): row[column].strip()
        for row in rows
        if len(row) == 5 and row[1].startswith(" `")
    }
    assert set(shown) == set(TISSUES)
    for tissue, errors in shown.items():
        found = [100 * c.relative_error(TISSUES[tissue].material) for c in curves]
        assert errors == " / ".join(f"{error:.0f}" for error in found)


@pytest.mark.parametrize("factor", [1000.0, 0.001])
def test_stress_in_another_unit_makes_no_soft_tissue(factor: float) -> None:
    """1000 Pa taken for 1000 kPa made a brain of 1 MPa without a word."""
    material = NeoHookean(factor * 1000.0, 0.45)
    fit = fit_law(curves_of(material), "neo-hookean", bulk=bulk_modulus_by_ratio(0.45))
    assert "is the stress in kPa, or Pa?" in fit.notes[-1]
