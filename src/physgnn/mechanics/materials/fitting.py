"""A law's parameters from measured stress, by least squares (SciPy).

All curves count alike: the residual of each is divided by the curve's own size, so that
the sum is that of the squared relative errors (`StressCurve.relative_error`). Ogden's
law has several minima; the fit starts from several exponents and keeps the best end.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.materials.fitted_laws import FAMILIES, BulkModulus, LawFamily
from physgnn.mechanics.materials.stress_curves import SHEAR, StressCurve
from physgnn.mechanics.materials.table import (
    Material,
    material_from_config,
    material_to_config,
)

FIRST_EXPONENTS = (-30.0, -10.0, -2.0, 2.0, 10.0, 30.0)
LARGEST_EXPONENT = 60.0
# From fat and brain (0.1 to 5 kPa) to muscle that is stretched.
SOFT_PA = (20.0, 200e3)
SMALLEST_EXPONENT = 0.1  # at 0 the term stands for a logarithm, which no law has
SMALLEST_MODULUS = 1e-6  # over the modulus the curves begin with
DIGITS = 6  # of a modulus or exponent; measured curves do not carry more
RATIO_DIGITS = 12  # of Poisson's ratio, whose distance from 0.5 counts
TOLERANCE = 1e-12

Bounds = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class Fit:
    """A fitted material and how well it follows the curves.

    Attributes
    ----------
    material : Material
    errors : mapping of str to float
        Kind of curve → RMS error over RMS stress.
    notes : tuple of str
        What the curves do not determine, and what is odd; a sentence each.
    """

    material: Material
    errors: Mapping[str, float]
    notes: tuple[str, ...] = ()


def fit_law(
    curves: Sequence[StressCurve], law: str, *, bulk: BulkModulus, terms: int = 1
) -> Fit:
    """Fit a law to curves, tension, compression and shear together.

    Parameters
    ----------
    curves : sequence of StressCurve
    law : str
        A key of `FAMILIES`.
    bulk : callable
        The bulk modulus, which such curves do not determine: `bulk_modulus_by_ratio`
        or `constant_bulk_modulus`.
    terms : int
        Of Ogden's law; others have one.

    Returns
    -------
    Fit
        Moduli are not negative, so that the law is stable at any strain.

    Raises
    ------
    InputError
        If the law is unknown or has not so many terms, there are no more points than
        parameters, or no parameters make the law follow the curves.
    """
    family = _family(law, terms)
    n_moduli = family.n_moduli(terms)
    n_points = sum(np.count_nonzero(curve.strain) for curve in curves)
    n_parameters = n_moduli * (2 if family.has_exponents else 1)
    if n_points <= n_parameters:
        raise InputError(
            f"{n_parameters} parameters need more points beside rest (got {n_points})"
        )
    scale = _first_modulus(curves)
    exponents = _first_exponents(n_moduli) if family.has_exponents else [()]
    with np.errstate(over="ignore", invalid="ignore"):  # steps too far are taken back
        ends = [
            _fit_from(curves, family, bulk, scale, (n_moduli, e)) for e in exponents
        ]
    found = [end for end in ends if end is not None]
    if not found:
        raise InputError(f"law '{law}' cannot follow these curves: try another")
    best = min(found, key=lambda end: float(end.cost))
    moduli, powers = best.x[:n_moduli], best.x[n_moduli:]
    if n_moduli > 1:
        moduli = np.where(moduli > 10 * SMALLEST_MODULUS, moduli, 0.0)
    material = _rounded(family.make(scale * moduli, powers, bulk))
    return Fit(
        material,
        {curve.kind: curve.relative_error(material) for curve in curves},
        tuple(_notes(material, moduli, powers)),
    )


def _notes(material: Material, moduli: FloatArray, powers: FloatArray) -> Iterator[str]:
    """Yield what the fit left undetermined."""
    if material.lam < 0:
        yield (
            "the bulk modulus is so small that Poisson's ratio is negative: "
            "is it in Pa?"
        )
    size = np.abs(powers)
    at_ends = (size > 0.99 * LARGEST_EXPONENT) | (size < 1.01 * SMALLEST_EXPONENT)
    if at_ends.any():
        yield (
            f"an exponent ended at {powers[at_ends][0]:.3g}, where the search ends: "
            "the curves do not determine it"
        )
    alike = len(powers) == 2 and abs(powers[0] - powers[1]) < 0.01 * size.max()
    if alike or (len(powers) == 2 and (moduli == 0).any()):
        yield "the curves determine one term alone: take --terms 1"
    low, high = SOFT_PA
    modulus_pa = 1e6 * material.mu
    if not low <= modulus_pa <= high:
        yield (
            f"the shear modulus at rest is {modulus_pa / 1000:.3g} kPa, where soft "
            f"tissue has {low / 1000:g} to {high / 1000:g}: is the stress in kPa, or "
            "Pa?"
        )


def _family(law: str, terms: int) -> LawFamily:
    if law not in FAMILIES:
        raise InputError(f"no fit for law '{law}' (there are: {', '.join(FAMILIES)})")
    family = FAMILIES[law]
    if not 1 <= terms <= family.most_terms:
        raise InputError(
            f"terms of law '{law}' must be in 1…{family.most_terms} (got {terms})"
        )
    return family


def _first_modulus(curves: Sequence[StressCurve]) -> float:
    """Return the shear modulus of a linear law through the curves, Pa."""
    slopes = [
        (curve.stress_pa @ curve.strain / (curve.strain @ curve.strain))
        / (1 if curve.kind == SHEAR else 3)  # E = 3μ where the volume stays
        for curve in curves
    ]
    return float(np.mean(slopes))


def _first_exponents(n: int) -> list[tuple[float, ...]]:
    """Return starts for the exponents, every pair but equal ones."""
    return [
        start
        for start in combinations_with_replacement(FIRST_EXPONENTS, n)
        if len(set(start)) == n
    ]


def _fit_from(
    curves: Sequence[StressCurve],
    family: LawFamily,
    bulk: BulkModulus,
    scale: float,
    start: tuple[int, tuple[float, ...]],
) -> OptimizeResult | None:
    """Return where least squares ends, or None if the law fails on the way."""
    n, exponents = start

    def residual(x: FloatArray) -> FloatArray:
        # NaN, where the law has no stress, makes least_squares take a shorter step.
        material = family.make(scale * x[:n], x[n:], bulk)
        misses = [
            (curve.stress_of(material) - curve.stress_pa)
            / np.linalg.norm(curve.stress_pa)
            for curve in curves
        ]
        return np.concatenate(misses)

    first = np.array([*np.full(n, (2 if exponents else 1) / n), *exponents])
    try:
        return least_squares(
            residual,
            first,
            jac="3-point",
            bounds=_bounds(n, exponents),
            xtol=TOLERANCE,
            ftol=TOLERANCE,
            gtol=TOLERANCE,
        )
    except ValueError:  # the law has no stress at the start, or beside it
        return None


def _bounds(n_moduli: int, exponents: tuple[float, ...]) -> Bounds:
    """Return bounds: moduli positive, exponents of the sign they start with."""
    lower, upper = [SMALLEST_MODULUS] * n_moduli, [np.inf] * n_moduli
    for start in exponents:
        ends = SMALLEST_EXPONENT, LARGEST_EXPONENT
        lower.append(ends[0] if start > 0 else -ends[1])
        upper.append(ends[1] if start > 0 else -ends[0])
    return np.array(lower), np.array(upper)


def _rounded(material: Material) -> Material:
    """Return the material with parameters as short as they are known."""

    def short(value: float, digits: int) -> float:
        return float(f"{value:.{digits}g}")

    config = material_to_config(material)
    for name, value in config.items():
        digits = RATIO_DIGITS if name == "poissons_ratio" else DIGITS
        if isinstance(value, tuple):
            config[name] = tuple(short(term, digits) for term in value)
        elif isinstance(value, float):
            config[name] = short(value, digits)
    return material_from_config(config)
