"""Uncoupled Ogden solid, FEBio's "Ogden"."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.materials.eigen import symmetric_eigen

MAX_TERMS = 3


@dataclass(frozen=True)
class Ogden:
    """W = Σᵢ cᵢ/mᵢ² (λ̃₁^mᵢ + λ̃₂^mᵢ + λ̃₃^mᵢ − 3) + k/2 (ln J)², λ̃ = J^(−1/3) λ.

    Source: FEBio User Manual, "Ogden" (uncoupled); Ogden, *Non-Linear Elastic
    Deformations*, 1984, §7.2. Where a paper writes Σ 2μᵢ/αᵢ² (…), as for brain tissue
    is usual, c = 2μ and m = α.

    Parameters
    ----------
    coefficients_pa : 1 to 3 floats
        cᵢ, Pa; the rest state's shear modulus is μ = ½ Σ cᵢ > 0.
    exponents : as many floats
        mᵢ, not zero.
    bulk_modulus_pa : float
        Bulk modulus k of the rest state, Pa.

    Raises
    ------
    InputError
        If the numbers don't pair up, an exponent is zero, or μ or k is not positive.
    """

    coefficients_pa: tuple[float, ...]
    exponents: tuple[float, ...]
    bulk_modulus_pa: float

    law: ClassVar[str] = "ogden"

    def __post_init__(self) -> None:
        c = tuple(float(value) for value in self.coefficients_pa)
        m = tuple(float(value) for value in self.exponents)
        object.__setattr__(self, "coefficients_pa", c)
        object.__setattr__(self, "exponents", m)
        if not 1 <= len(c) == len(m) <= MAX_TERMS:
            raise InputError(
                f"coefficients_pa and exponents must be 1 to {MAX_TERMS} pairs "
                f"(got {len(c)} and {len(m)} numbers)"
            )
        if not np.isfinite(c + m).all() or 0.0 in m:
            raise InputError(f"exponents must be finite and not 0 (got {m})")
        if not sum(c) > 0:
            raise InputError(
                "coefficients_pa must have a positive sum, twice the shear modulus "
                f"(got {sum(c)})"
            )
        if not 0 < self.bulk_modulus_pa < np.inf:
            raise InputError(
                f"bulk_modulus_pa must be > 0 (got {self.bulk_modulus_pa})"
            )

    @property
    def mu(self) -> float:
        """Shear modulus of the rest state, MPa."""
        return 0.5e-6 * sum(self.coefficients_pa)

    @property
    def lam(self) -> float:
        """Lamé's first parameter of the rest state, λ = k − 2μ/3, MPa."""
        return 1e-6 * self.bulk_modulus_pa - 2 * self.mu / 3

    @property
    def constants(self) -> FloatArray:
        """(k, c₁, m₁, c₂, m₂, …), k and c in MPa, as the kernels take them."""
        pairs = zip(self.coefficients_pa, self.exponents, strict=True)
        terms = [value for c, m in pairs for value in (1e-6 * c, m)]
        return np.array([1e-6 * self.bulk_modulus_pa, *terms])


@njit(cache=True, inline="always")
def _principal(F, x, N):  # type: ignore[no-untyped-def]
    """Fill x with the squares of the principal stretches, N with their directions."""
    C = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for m in range(3):
                C[i, j] += F[m, i] * F[m, j]
    symmetric_eigen(C, N)
    for a in range(3):
        x[a] = C[a, a]


@njit(cache=True)
def energy(F, J, constants):  # type: ignore[no-untyped-def]  # noqa: D103
    x, N = np.empty(3), np.empty((3, 3))
    _principal(F, x, N)
    lnJ = np.log(J)
    total = 0.5 * constants[0] * lnJ**2
    for term in range(1, len(constants) - 1, 2):
        c, m = constants[term], constants[term + 1]
        if c != 0.0:
            for a in range(3):
                # λ̃^m − 1 without loss of digits near the rest state.
                total += c / m**2 * np.expm1(m * (np.log(x[a]) / 2 - lnJ / 3))
    return total


@njit(cache=True)
def stress(F, H, J, constants, P):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """P = F S, S = Σₐ sₐ Nₐ ⊗ Nₐ, sₐ = (βₐ + k ln J) / λₐ², βₐ = λₐ ∂W̃/∂λₐ."""
    x, N, s = np.empty(3), np.empty((3, 3)), np.empty(3)
    _principal(F, x, N)
    lnJ = np.log(J)
    s[:] = constants[0] * lnJ
    for term in range(1, len(constants) - 1, 2):
        c, m = constants[term], constants[term + 1]
        if c != 0.0:
            _add_deviatoric(x, lnJ, c, m, s)
    for i in range(3):
        for j in range(3):
            P[i, j] = 0.0
    for a in range(3):
        s[a] /= x[a]
        for i in range(3):
            m_i = F[i, 0] * N[0, a] + F[i, 1] * N[1, a] + F[i, 2] * N[2, a]
            for j in range(3):
                P[i, j] += s[a] * m_i * N[j, a]


@njit(cache=True, inline="always")
def _add_deviatoric(x, lnJ, c, m, beta):  # type: ignore[no-untyped-def]
    """Add c/m (λ̃ₐ^m − mean) of one term to β."""
    e0 = np.expm1(m * (np.log(x[0]) / 2 - lnJ / 3))
    e1 = np.expm1(m * (np.log(x[1]) / 2 - lnJ / 3))
    e2 = np.expm1(m * (np.log(x[2]) / 2 - lnJ / 3))
    mean = (e0 + e1 + e2) / 3
    beta[0] += c / m * (e0 - mean)
    beta[1] += c / m * (e1 - mean)
    beta[2] += c / m * (e2 - mean)


@njit(cache=True, inline="always")
def _power_slope(x, y, p):  # type: ignore[no-untyped-def]
    """Divided difference (y^p − x^p) / (y − x), accurate for any x and y > 0."""
    r = (y - x) / x
    return x ** (p - 1) * (p if r == 0.0 else np.expm1(p * np.log1p(r)) / r)


@njit(cache=True)
def _coefficients(x, J, constants, s, gamma, d):  # type: ignore[no-untyped-def]
    """Fill sₐ, γ_ab = ∂sₐ/∂λ_b / λ_b and d_ab = (s_b − sₐ)/(λ_b² − λₐ²).

    With J and the mean q held common, sₐ = f(λₐ²), f(x) = Σ c/m J^(−m/3) x^(m/2−1) −
    q/x; so d is the divided difference of f, which stays exact as stretches meet.
    """
    lnJ = np.log(J)
    k = constants[0]
    q = -k * lnJ
    s[:] = k * lnJ
    gamma[:] = k
    d[:] = 0.0
    for term in range(1, len(constants) - 1, 2):
        c, m = constants[term], constants[term + 1]
        if c == 0.0:
            continue
        _add_deviatoric(x, lnJ, c, m, s)
        scale = J ** (-m / 3)
        w0, w1, w2 = (
            c * scale * x[0] ** (m / 2),
            c * scale * x[1] ** (m / 2),
            c * scale * x[2] ** (m / 2),
        )
        w = (w0, w1, w2)
        total = w0 + w1 + w2
        q += total / (3 * m)
        for a in range(3):
            gamma[a, a] += w[a]
            for b in range(3):
                gamma[a, b] += total / 9 - (w[a] + w[b]) / 3
                d[a, b] += c / m * scale * _power_slope(x[a], x[b], m / 2 - 1)
    for a in range(3):
        s[a] /= x[a]
        for b in range(3):
            d[a, b] += q / (x[a] * x[b])
            gamma[a, b] /= x[a] * x[b]
    for a in range(3):
        gamma[a, a] -= 2 * s[a] / x[a]


@njit(cache=True)
def tangent(F, H, J, constants, A):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """∂P/∂F = Σ γ_ab Dₐₐ⊗D_bb + Σ_{a≠b} d_ab (D_ab⊗D_ab + D_ab⊗D_bₐ) + δ_ik S_JL.

    Here D_ab = (F Nₐ) ⊗ N_b. Source: Holzapfel, *Nonlinear Solid Mechanics*, 2000,
    eq. 6.180, pushed to the first Piola–Kirchhoff stress.
    """
    x, N, s = np.empty(3), np.empty((3, 3)), np.empty(3)
    gamma, d = np.empty((3, 3)), np.empty((3, 3))
    _principal(F, x, N)
    _coefficients(x, J, constants, s, gamma, d)
    M = F @ N
    A[:] = 0.0
    for a in range(3):
        for b in range(3):
            for i in range(3):
                for j in range(3):
                    straight = gamma[a, b] * M[i, a] * N[j, a]
                    crossed = d[a, b] * M[i, a] * N[j, b] if a != b else 0.0
                    for k in range(3):
                        for n in range(3):
                            A[i, j, k, n] += straight * M[k, b] * N[n, b] + crossed * (
                                M[k, a] * N[n, b] + M[k, b] * N[n, a]
                            )
        for i in range(3):
            for j in range(3):
                for n in range(3):
                    A[i, j, i, n] += s[a] * N[j, a] * N[n, a]
