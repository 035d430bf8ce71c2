"""Internal force, energy and scaled mass at integration points, total Lagrangian.

Gradients are those of the undeformed body, so they are found once.
"""

from typing import Any

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.mechanics.elements.cell_kinematics import inverse_transpose
from physgnn.mechanics.elements.tet4 import Elements
from physgnn.mechanics.materials import table
from physgnn.mechanics.meshless.integration import IntegrationPoints


@njit(cache=True, inline="always")
def _gradient(q, start, nodes, gradients, rest, u, F):  # type: ignore[no-untyped-def]
    """Fill F = g⁻¹ (I + Σ_j u_j ⊗ ∂φ_j/∂X), where g⁻¹ = rest."""
    f00, f01, f02 = rest, 0.0, 0.0
    f10, f11, f12 = 0.0, rest, 0.0
    f20, f21, f22 = 0.0, 0.0, rest
    for n in range(start[q], start[q + 1]):
        j = nodes[n]
        x, y, z = rest * u[j, 0], rest * u[j, 1], rest * u[j, 2]
        a, b, c = gradients[n, 0], gradients[n, 1], gradients[n, 2]
        f00 += x * a
        f01 += x * b
        f02 += x * c
        f10 += y * a
        f11 += y * b
        f12 += y * c
        f20 += z * a
        f21 += z * b
        f22 += z * c
    F[0, 0], F[0, 1], F[0, 2] = f00, f01, f02
    F[1, 0], F[1, 1], F[1, 2] = f10, f11, f12
    F[2, 0], F[2, 1], F[2, 2] = f20, f21, f22


@njit(cache=True)
def _internal_force(  # type: ignore[no-untyped-def]
    start, nodes, gradients, per_cell, volumes, law, constants, rest, u, force
):
    F, H, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for q in range(len(start) - 1):
        e = q // per_cell
        _gradient(q, start, nodes, gradients, rest[e], u, F)
        J = inverse_transpose(F, H)
        if not J > 0.0:
            return e
        table.stress(law[e], F, H, J, constants[e], P)
        scale = volumes[e] * rest[e] / per_cell
        for i in range(3):
            for j in range(3):
                P[i, j] *= scale
        for n in range(start[q], start[q + 1]):
            a, b, c = gradients[n, 0], gradients[n, 1], gradients[n, 2]
            for i in range(3):
                force[nodes[n], i] += P[i, 0] * a + P[i, 1] * b + P[i, 2] * c
    return -1


@njit(cache=True)
def _strain_energy(  # type: ignore[no-untyped-def]
    start, nodes, gradients, per_cell, volumes, law, constants, rest, u
):
    F, H, total = np.empty((3, 3)), np.empty((3, 3)), 0.0
    for q in range(len(start) - 1):
        e = q // per_cell
        _gradient(q, start, nodes, gradients, rest[e], u, F)
        J = inverse_transpose(F, H)
        if not J > 0.0:
            return np.inf
        total += volumes[e] / per_cell * table.energy(law[e], F, J, constants[e])
    return total


@njit(cache=True)
def _scaled_mass(start, nodes, gradients, per_cell, stiffness, mass):  # type: ignore[no-untyped-def]
    for q in range(len(start) - 1):
        total = 0.0
        for n in range(start[q], start[q + 1]):
            total += float(np.linalg.norm(gradients[n]))
        for n in range(start[q], start[q + 1]):
            length = np.linalg.norm(gradients[n])
            mass[nodes[n]] += stiffness[q // per_cell] / per_cell * length * total


def internal_force(
    at: IntegrationPoints, elements: Elements, u: FloatArray
) -> tuple[FloatArray, int]:
    """Σ_q V_q P(F_q) ∂φ/∂X.

    Parameters
    ----------
    at : IntegrationPoints
    elements : Elements
        Law, constants, volume and growth of every cell.
    u : (n_points, 3) array
        Nodal parameters, mm.

    Returns
    -------
    force : (n_points, 3) array
        N.
    inverted : int
        First cell with det F ≤ 0, or −1; the force is then of no use.
    """
    force = np.zeros_like(u)
    inverted = _internal_force(*_arguments(at, elements), u, force)
    return force, int(inverted)


def strain_energy(at: IntegrationPoints, elements: Elements, u: FloatArray) -> float:
    """Σ_q V_q W(F_q), N·mm; infinite if a cell is inverted."""
    return float(_strain_energy(*_arguments(at, elements), u))


def scaled_mass(
    at: IntegrationPoints, n_points: int, stiffness: FloatArray
) -> FloatArray:
    """Return masses that make every frequency at rest about 1 or less, (n_points,).

    Parameters
    ----------
    at : IntegrationPoints
    n_points : int
    stiffness : (n_cells,) array
        V (3λ + 2μ) of every cell, N·mm.

    Notes
    -----
    uᵀ K_q u ≤ V (3λ + 2μ) |∇u|², and by Cauchy's inequality |∇u|² ≤ Σ_j |u_j|² m_j for
    m_j = |∂φ_j| Σ_i |∂φ_i|. Summed over q, M − K is positive semi-definite.
    """
    mass = np.zeros(n_points)
    _scaled_mass(at.start, at.nodes, at.gradients, at.per_cell, stiffness, mass)
    return mass


def _arguments(
    at: IntegrationPoints, elements: Elements
) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any]:
    return (
        at.start,
        at.nodes,
        at.gradients,
        at.per_cell,
        elements.volumes,
        elements.law,
        elements.constants,
        elements.rest,
    )
