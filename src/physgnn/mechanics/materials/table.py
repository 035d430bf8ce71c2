"""The table of laws, and the one place where kernels choose among them.

A law is a frozen dataclass (its parameters, with units) and three compiled
functions: energy, stress P and tangent ∂P/∂F. A new law is a file and a row.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.mechanics.materials import neo_hookean
from physgnn.mechanics.materials.neo_hookean import NeoHookean


class Material(Protocol):
    """What every law offers."""

    @property
    def law(self) -> str:
        """Its name in the table."""

    @property
    def constants(self) -> NDArray[np.float64]:
        """Its constants in MPa, as the kernels take them."""


LAWS: dict[str, type] = {NeoHookean.law: NeoHookean}
LAW_INDEX = {name: index for index, name in enumerate(LAWS)}
MAX_CONSTANTS = 8


@njit(cache=True)
def energy(law, F, J, constants):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Return the energy stored in a unit of reference volume, MPa."""
    return neo_hookean.energy(F, J, constants)


@njit(cache=True)
def stress(law, F, H, J, constants, P):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Fill P, the first Piola–Kirchhoff stress, MPa."""
    neo_hookean.stress(F, H, J, constants, P)


@njit(cache=True)
def tangent(law, F, H, J, constants, A):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Fill A, the tangent ∂P/∂F, MPa."""
    neo_hookean.tangent(F, H, J, constants, A)


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
