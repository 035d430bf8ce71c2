"""The table of laws, and the one place where kernels choose among them.

A law is a frozen dataclass (its parameters, with units) and three compiled
functions: energy, stress P and tangent ∂P/∂F. A new law is a file, a row, and a
branch in each function here.

In every law the change of volume costs ½ κ (ln J)², and κ is the first constant:
elements that average the change of volume rely on it.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Protocol

from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.materials import mooney_rivlin, neo_hookean, ogden
from physgnn.mechanics.materials.mooney_rivlin import MooneyRivlin
from physgnn.mechanics.materials.neo_hookean import NeoHookean
from physgnn.mechanics.materials.ogden import Ogden


class Material(Protocol):
    """What every law offers."""

    @property
    def law(self) -> str:
        """Its name in the table."""

    @property
    def mu(self) -> float:
        """Shear modulus of the rest state, MPa."""

    @property
    def lam(self) -> float:
        """Lamé's first parameter of the rest state, MPa."""

    @property
    def constants(self) -> FloatArray:
        """Its constants in MPa, as the kernels take them."""


# In the order of the branches below.
LAWS: dict[str, type] = {law.law: law for law in (NeoHookean, MooneyRivlin, Ogden)}
LAW_INDEX = {name: index for index, name in enumerate(LAWS)}
MAX_CONSTANTS = 8
NO_BRANCH = "this law of the table has no branch in table.py: add one to each function"


@njit(cache=True, inline="always")
def energy(law, F, J, constants):  # type: ignore[no-untyped-def]
    """Return the energy stored in a unit of reference volume, MPa."""
    if law == 0:
        return neo_hookean.energy(F, J, constants)
    if law == 1:
        return mooney_rivlin.energy(F, J, constants)
    if law == 2:
        return ogden.energy(F, J, constants)
    raise ValueError(NO_BRANCH)


@njit(cache=True, inline="always")
def stress(law, F, H, J, constants, P):  # type: ignore[no-untyped-def]
    """Fill P, the first Piola–Kirchhoff stress, MPa; H = F⁻ᵀ."""
    if law == 0:
        neo_hookean.stress(F, H, J, constants, P)
    elif law == 1:
        mooney_rivlin.stress(F, H, J, constants, P)
    elif law == 2:
        ogden.stress(F, H, J, constants, P)
    else:
        raise ValueError(NO_BRANCH)


@njit(cache=True, inline="always")
def tangent(law, F, H, J, constants, A):  # type: ignore[no-untyped-def]
    """Fill A, the tangent ∂P/∂F, MPa; H = F⁻ᵀ."""
    if law == 0:
        neo_hookean.tangent(F, H, J, constants, A)
    elif law == 1:
        mooney_rivlin.tangent(F, H, J, constants, A)
    elif law == 2:
        ogden.tangent(F, H, J, constants, A)
    else:
        raise ValueError(NO_BRANCH)


def law_index(material: Material) -> int:
    """Return the number that kernels know a law by; InputError if there is none."""
    if material.law not in LAW_INDEX:
        raise InputError(
            f"material law '{material.law}' is not in the table (there are: "
            f"{', '.join(LAWS)}): give it a row, and a branch in each function there"
        )
    return LAW_INDEX[material.law]


def material_from_config(values: Mapping[str, object]) -> Material:
    """Make a material from a law's name and its parameters.

    Raises
    ------
    InputError
        If the law or a parameter is unknown, missing or out of range.
    """
    chosen = dict(values)
    law = str(chosen.pop("law", NeoHookean.law))
    if law not in LAWS:
        raise InputError(f"unknown material law '{law}' (there are: {', '.join(LAWS)})")
    names = [f.name for f in fields(LAWS[law])]
    if set(chosen) != set(names):
        raise InputError(
            f"material law '{law}' takes {', '.join(names)} "
            f"(got {', '.join(chosen) or 'nothing'})"
        )
    material: Material = LAWS[law](**chosen)
    return material


def material_to_config(material: Material) -> dict[str, object]:
    """Return the law's name and parameters, the inverse of `material_from_config`."""
    names = [f.name for f in fields(LAWS[material.law])]
    return {"law": material.law, **{name: getattr(material, name) for name in names}}
