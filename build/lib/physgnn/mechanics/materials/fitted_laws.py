"""The laws that can be fitted to measured stress, and what is assumed beside them.

A law is made of moduli, exponents if it has them, and a bulk modulus: tests with free
sides tell hardly anything about the change of volume, so that it is assumed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.materials.mooney_rivlin import MooneyRivlin
from physgnn.mechanics.materials.neo_hookean import NeoHookean
from physgnn.mechanics.materials.ogden import Ogden
from physgnn.mechanics.materials.table import Material

BulkModulus = Callable[[float], float]
"""Shear modulus of the rest state → bulk modulus, both Pa."""


@dataclass(frozen=True)
class LawFamily:
    """How a law is made of the numbers that are fitted.

    Attributes
    ----------
    make : callable
        (moduli in Pa, exponents, bulk modulus) → Material.
    n_moduli : callable
        Terms → how many moduli.
    has_exponents : bool
        Whether every modulus has an exponent beside it.
    most_terms : int
    """

    make: Callable[[FloatArray, FloatArray, BulkModulus], Material]
    n_moduli: Callable[[int], int]
    has_exponents: bool = False
    most_terms: int = 1


def bulk_modulus_by_ratio(poissons_ratio: float) -> BulkModulus:
    """Return κ = 2μ (1 + ν) / (3 (1 − 2ν)) as a function of μ.

    Raises
    ------
    InputError
        If ν is not in [0, 0.5).
    """
    if not 0 <= poissons_ratio < 0.5:
        raise InputError(f"Poisson's ratio must be in [0, 0.5) (got {poissons_ratio})")
    factor = 2 * (1 + poissons_ratio) / (3 * (1 - 2 * poissons_ratio))
    return lambda mu_pa: factor * mu_pa


def constant_bulk_modulus(bulk_modulus_pa: float) -> BulkModulus:
    """Return the same κ for every μ.

    Raises
    ------
    InputError
        If κ is not positive.
    """
    if not 0 < bulk_modulus_pa < np.inf:
        raise InputError(f"the bulk modulus must be > 0 Pa (got {bulk_modulus_pa})")
    return lambda _: bulk_modulus_pa


def _neo_hookean(mu: FloatArray, _: FloatArray, bulk: BulkModulus) -> Material:
    """Turn μ and κ into E = 9κμ / (3κ + μ) and ν = (3κ − 2μ) / (2 (3κ + μ))."""
    shear = float(mu[0])
    kappa = bulk(shear)
    return NeoHookean(
        9 * kappa * shear / (3 * kappa + shear),
        (3 * kappa - 2 * shear) / (2 * (3 * kappa + shear)),
    )


def _mooney_rivlin(c: FloatArray, _: FloatArray, bulk: BulkModulus) -> Material:
    c1, c2 = c.tolist()
    return MooneyRivlin(c1, c2, bulk(2 * (c1 + c2)))


def _ogden(c: FloatArray, m: FloatArray, bulk: BulkModulus) -> Material:
    return Ogden(tuple(c.tolist()), tuple(m.tolist()), bulk(float(c.sum()) / 2))


FAMILIES: Mapping[str, LawFamily] = {
    "neo-hookean": LawFamily(_neo_hookean, lambda _: 1),
    "mooney-rivlin": LawFamily(_mooney_rivlin, lambda _: 2),
    "ogden": LawFamily(_ogden, lambda n: n, has_exponents=True, most_terms=2),
}
