"""Compressible neo-Hookean solid, FEBio's "neo-Hookean" (coupled form)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError


@dataclass(frozen=True)
class NeoHookean:
    """W = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)².

    Source: FEBio User Manual 4, "neo-Hookean"; Bonet & Wood, *Nonlinear Continuum
    Mechanics for Finite Element Analysis*, 2nd ed., eq. 6.27.

    Parameters
    ----------
    youngs_modulus_pa : float
        Young's modulus of the rest state, Pa.
    poissons_ratio : float
        Poisson's ratio of the rest state, in (−1, 0.5).

    Raises
    ------
    InputError
        If either is out of range.
    """

    youngs_modulus_pa: float
    poissons_ratio: float

    law: ClassVar[str] = "neo-hookean"

    def __post_init__(self) -> None:
        if not 0 < self.youngs_modulus_pa < np.inf:
            raise InputError(
                f"youngs_modulus_pa must be > 0 (got {self.youngs_modulus_pa})"
            )
        if not -1 < self.poissons_ratio < 0.5:
            raise InputError(
                f"poissons_ratio must be in (-1, 0.5) (got {self.poissons_ratio})"
            )

    @property
    def mu(self) -> float:
        """Shear modulus μ = E / (2 (1 + ν)), MPa."""
        return 1e-6 * self.youngs_modulus_pa / (2 * (1 + self.poissons_ratio))

    @property
    def lam(self) -> float:
        """Lamé's first parameter λ = E ν / ((1 + ν)(1 − 2ν)), MPa."""
        nu = self.poissons_ratio
        return 1e-6 * self.youngs_modulus_pa * nu / ((1 + nu) * (1 - 2 * nu))

    @property
    def constants(self) -> FloatArray:
        """(λ, μ) in MPa, as the kernels take them."""
        return np.array([self.lam, self.mu])


@njit(cache=True, inline="always")
def energy(F, J, constants):  # type: ignore[no-untyped-def]  # noqa: D103
    lam, mu = constants[0], constants[1]
    I1 = 0.0
    for i in range(3):
        for j in range(3):
            I1 += F[i, j] * F[i, j]
    lnJ = np.log(J)
    return mu / 2 * (I1 - 3) - mu * lnJ + lam / 2 * lnJ**2


@njit(cache=True, inline="always")
def stress(F, H, J, constants, P):  # type: ignore[no-untyped-def]
    """P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ, with H = F⁻ᵀ."""
    lam, mu = constants[0], constants[1]
    p = lam * np.log(J) - mu
    for i in range(3):
        for j in range(3):
            P[i, j] = mu * F[i, j] + p * H[i, j]


@njit(cache=True, inline="always")
def tangent(F, H, J, constants, A):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """∂P/∂F: A_iJkL = μ δ_ik δ_JL + (μ − λ ln J) H_iL H_kJ + λ H_iJ H_kL."""
    lam, mu = constants[0], constants[1]
    q = mu - lam * np.log(J)
    for i in range(3):
        for j in range(3):
            for k in range(3):
                for m in range(3):
                    A[i, j, k, m] = q * H[i, m] * H[k, j] + lam * H[i, j] * H[k, m]
            A[i, j, i, j] += mu


@njit(cache=True, inline="always")
def stiffness(gradient, volume, H, J, constants, g, K):  # type: ignore[no-untyped-def]
    """Fill the tangent of a linear tetrahedron, blocks b ≥ a, in a third of the time.

    With g_a = F⁻ᵀ ∂N_a/∂X, V A contracted with both gradients is
    K_aibk = V (μ δ_ik ∂N_a·∂N_b + (μ − λ ln J) g_ak g_bi + λ g_ai g_bk).
    """
    lam, mu = volume * constants[0], volume * constants[1]
    q = mu - lam * np.log(J)
    for a in range(4):
        for i in range(3):
            g[a, i] = (
                H[i, 0] * gradient[a, 0]
                + H[i, 1] * gradient[a, 1]
                + H[i, 2] * gradient[a, 2]
            )
    for a in range(4):
        for b in range(a, 4):
            same = mu * (
                gradient[a, 0] * gradient[b, 0]
                + gradient[a, 1] * gradient[b, 1]
                + gradient[a, 2] * gradient[b, 2]
            )
            for i in range(3):
                for k in range(3):
                    K[a, b, i, k] = q * g[a, k] * g[b, i] + lam * g[a, i] * g[b, k]
                K[a, b, i, i] += same
