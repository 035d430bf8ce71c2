"""Stress of a law where a test machine deforms a sample alike everywhere.

In tension and compression the sample is stretched along one axis and its sides are
free: F = diag(λ, λₜ, λₜ), with λₜ from Pₜ = 0 by Newton's method. In simple shear
F = I + γ e₁ ⊗ e₂, which keeps the volume. Source: Holzapfel, *Nonlinear Solid
Mechanics*, 2000, §6.6; Budday et al. 2017, Acta Biomater. 48, which the curves of brain
are from, assume the same.
"""

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.mechanics.materials import table
from physgnn.mechanics.materials.table import Material, law_index

MAX_ITERATIONS = 60
LARGEST_STEP = 0.1  # of ln λₜ
SMALLEST_STEP = 1e-14


def uniaxial_stress(material: Material, stretch: FloatArray) -> FloatArray:
    """Return the nominal stress along the axis of stretching, free sides.

    Parameters
    ----------
    material : Material
    stretch : (n,) array
        λ > 0, length over length at rest.

    Returns
    -------
    (n,) array
        P₁₁, Pa; NaN where no width leaves the sides free.
    """
    found: FloatArray = 1e6 * _stretched(material, stretch)[:, 0]
    return found


def free_width(material: Material, stretch: FloatArray) -> FloatArray:
    """Return λₜ, the stretch of the free sides, (n,), for stretches along the axis."""
    found: FloatArray = _stretched(material, stretch)[:, 1]
    return found


def _stretched(material: Material, stretch: FloatArray) -> FloatArray:
    stretch = np.ascontiguousarray(stretch, dtype=np.float64)
    found: FloatArray = _uniaxial(law_index(material), stretch, material.constants)
    return found


def shear_stress(material: Material, amount: FloatArray) -> FloatArray:
    """Return the shear stress P₁₂ = σ₁₂ of simple shear, Pa.

    Parameters
    ----------
    material : Material
    amount : (n,) array
        γ, displacement over height.
    """
    amount = np.ascontiguousarray(amount, dtype=np.float64)
    found: FloatArray = 1e6 * _shear(law_index(material), amount, material.constants)
    return found


@njit(cache=True)
def _uniaxial(law, stretch, constants):  # type: ignore[no-untyped-def]
    """Stress along the axis, MPa, and stretch of the sides, one row a stretch."""
    F, H, P = np.zeros((3, 3)), np.zeros((3, 3)), np.empty((3, 3))
    A = np.empty((3, 3, 3, 3))
    found = np.full((len(stretch), 2), np.nan)
    for row in range(len(stretch)):
        F[0, 0] = stretch[row]
        log_width = -np.log(stretch[row]) / 2  # as if incompressible
        for _ in range(MAX_ITERATIONS):
            width = np.exp(log_width)
            F[1, 1] = F[2, 2] = width
            for i in range(3):
                H[i, i] = 1 / F[i, i]
            J = F[0, 0] * width * width
            table.stress(law, F, H, J, constants, P)
            table.tangent(law, F, H, J, constants, A)
            slope = (A[1, 1, 1, 1] + A[1, 1, 2, 2]) * width
            if not slope > 0:
                break
            step = -P[1, 1] / slope
            log_width += min(max(step, -LARGEST_STEP), LARGEST_STEP)
            if abs(step) < SMALLEST_STEP * (1 + abs(log_width)):
                found[row, 0], found[row, 1] = P[0, 0], width
                break
    return found


@njit(cache=True)
def _shear(law, amount, constants):  # type: ignore[no-untyped-def]
    F, H, P = np.eye(3), np.eye(3), np.empty((3, 3))
    found = np.empty(len(amount))
    for row in range(len(amount)):
        F[0, 1] = amount[row]
        H[1, 0] = -amount[row]
        table.stress(law, F, H, 1.0, constants, P)
        found[row] = P[0, 1]
    return found
