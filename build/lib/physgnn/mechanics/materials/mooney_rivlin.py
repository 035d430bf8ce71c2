"""Uncoupled Mooney–Rivlin solid, FEBio's "Mooney-Rivlin"."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError


@dataclass(frozen=True)
class MooneyRivlin:
    """W = c₁ (Ĩ₁ − 3) + c₂ (Ĩ₂ − 3) + k/2 (ln J)², Ĩ of F̃ = J^(−1/3) F.

    Source: FEBio Theory Manual, "Mooney-Rivlin Hyperelasticity"; U(J) = k/2 (ln J)²
    as FEBio takes it for all uncoupled materials.

    Parameters
    ----------
    c1_pa, c2_pa : float
        Coefficients, Pa; the rest state's shear modulus is μ = 2 (c₁ + c₂) > 0.
    bulk_modulus_pa : float
        Bulk modulus k of the rest state, Pa.

    Raises
    ------
    InputError
        If a coefficient is negative, or μ or k is not positive.
    """

    c1_pa: float
    c2_pa: float
    bulk_modulus_pa: float

    law: ClassVar[str] = "mooney-rivlin"

    def __post_init__(self) -> None:
        if not (0 <= self.c1_pa < np.inf and 0 <= self.c2_pa < np.inf):
            raise InputError(
                f"c1_pa and c2_pa must be ≥ 0 (got {self.c1_pa}, {self.c2_pa})"
            )
        if not self.c1_pa + self.c2_pa > 0:
            raise InputError(
                "c1_pa + c2_pa must be > 0 (the shear modulus is twice it)"
            )
        if not 0 < self.bulk_modulus_pa < np.inf:
            raise InputError(
                f"bulk_modulus_pa must be > 0 (got {self.bulk_modulus_pa})"
            )

    @property
    def mu(self) -> float:
        """Shear modulus of the rest state, MPa."""
        return 2e-6 * (self.c1_pa + self.c2_pa)

    @property
    def lam(self) -> float:
        """Lamé's first parameter of the rest state, λ = k − 2μ/3, MPa."""
        return 1e-6 * self.bulk_modulus_pa - 2 * self.mu / 3

    @property
    def constants(self) -> FloatArray:
        """(k, c₁, c₂) in MPa, as the kernels take them."""
        return 1e-6 * np.array([self.bulk_modulus_pa, self.c1_pa, self.c2_pa])


@njit(cache=True)
def energy(F, J, constants):  # type: ignore[no-untyped-def]  # noqa: D103
    k, c1, c2 = constants[0], constants[1], constants[2]
    C = F.T @ F
    I1 = C[0, 0] + C[1, 1] + C[2, 2]
    I2 = 0.5 * (I1**2 - np.sum(C * C))
    return (
        c1 * (I1 * J ** (-2 / 3) - 3)
        + c2 * (I2 * J ** (-4 / 3) - 3)
        + 0.5 * k * np.log(J) ** 2
    )


@njit(cache=True)
def _invariants(F, G):  # type: ignore[no-untyped-def]
    """Fill G = I₁ F − F FᵀF, half of ∂I₂/∂F; return I₁ and I₂ = ½ G : F."""
    I1, I2 = 0.0, 0.0
    for i in range(3):
        for j in range(3):
            I1 += F[i, j] * F[i, j]
    for i in range(3):
        for j in range(3):
            G[i, j] = I1 * F[i, j]
            for m in range(3):
                for n in range(3):
                    G[i, j] -= F[i, m] * F[n, m] * F[n, j]
            I2 += 0.5 * G[i, j] * F[i, j]
    return I1, I2


@njit(cache=True)
def stress(F, H, J, constants, P):  # type: ignore[no-untyped-def]
    """P = a (F − I₁/3 H) + b (G − 2/3 I₂ H) + k ln J H, with H = F⁻ᵀ.

    Here a = 2 c₁ J^(−2/3), b = 2 c₂ J^(−4/3) and G = ½ ∂I₂/∂F.
    """
    G = np.empty((3, 3))
    I1, I2 = _invariants(F, G)
    a, b = 2 * constants[1] * J ** (-2 / 3), 2 * constants[2] * J ** (-4 / 3)
    p = constants[0] * np.log(J) - a * (I1 / 3) - b * (2 * I2 / 3)
    for i in range(3):
        for j in range(3):
            P[i, j] = a * F[i, j] + b * G[i, j] + p * H[i, j]


@njit(cache=True)
def tangent(F, H, J, constants, A):  # type: ignore[no-untyped-def]
    """∂P/∂F of the stress above, by the product rule."""
    G = np.empty((3, 3))
    I1, I2 = _invariants(F, G)
    k = constants[0]
    a, b = 2 * constants[1] * J ** (-2 / 3), 2 * constants[2] * J ** (-4 / 3)
    p = k * np.log(J) - a * (I1 / 3) - b * (2 * I2 / 3)
    HH = k + (2 * a * I1 + 8 * b * I2) / 9
    left, right = F @ F.T, F.T @ F
    for i in range(3):
        for j in range(3):
            for m in range(3):
                for n in range(3):
                    A[i, j, m, n] = (
                        HH * H[i, j] * H[m, n]
                        - p * H[i, n] * H[m, j]
                        - 2 / 3 * a * (F[i, j] * H[m, n] + H[i, j] * F[m, n])
                        - 4 / 3 * b * (G[i, j] * H[m, n] + H[i, j] * G[m, n])
                        + b * (2 * F[i, j] * F[m, n] - F[i, n] * F[m, j])
                    )
            A[i, j, i, j] += a + b * I1
            for n in range(3):
                A[i, j, i, n] -= b * right[n, j]
                A[i, j, n, j] -= b * left[i, n]
