"""How the internal force curves along a direction: d²/ds² f_int(u + s v) at s = 0.

The right-hand side of the second-order term of a perturbation series
(`physgnn.learning.perturbation`).
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.mechanics.element import Elements, _add_force
from physgnn.mechanics.kinematics import kinematics
from physgnn.mechanics.materials import neo_hookean, table

FloatArray = NDArray[np.float64]

STEP = 0.002  # of the strain, in the difference that serves laws without a formula


@njit(cache=True, inline="always")
def _relative_gradient(cell, gradient, v, H, G, M):  # type: ignore[no-untyped-def]
    """Fill G = ∇v and M = F⁻¹ G; return the size of M."""
    for i in range(3):
        for j in range(3):
            G[i, j] = 0.0
            for a in range(4):
                G[i, j] += v[cell[a], i] * gradient[a, j]
    size = 0.0
    for i in range(3):
        for j in range(3):
            M[i, j] = H[0, i] * G[0, j] + H[1, i] * G[1, j] + H[2, i] * G[2, j]
            size += M[i, j] ** 2
    return np.sqrt(size)


@njit(cache=True)
def _difference(law, F, constants, G, step, P, curved):  # type: ignore[no-untyped-def]
    """Fill curved with the second difference of P along G."""
    H, near = np.empty((3, 3)), np.empty((3, 3))
    for sign in (-1.0, 0.0, 1.0):
        near[:] = F + sign * step * G
        J = np.linalg.det(near)
        H[:] = np.linalg.inv(near).T
        table.stress(law, near, H, J, constants, P)
        weight = (-2.0 if sign == 0.0 else 1.0) / step**2
        curved[:] = weight * P if sign == -1.0 else curved + weight * P


@njit(cache=True)
def _second_variation(cells, gradients, volumes, law, constants, u, v, force):  # type: ignore[no-untyped-def]
    F, H, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    G, M, curved = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(cells)):
        J = kinematics(cells[e], gradients[e], u, F, H)
        if not J > 0.0:
            return e
        size = _relative_gradient(cells[e], gradients[e], v, H, G, M)
        if law[e] == 0:
            neo_hookean.second_stress(H, J, constants[e], M, curved)
        else:
            _difference(law[e], F, constants[e], G, STEP / (size + 1e-12), P, curved)
        _add_force(cells[e], gradients[e], volumes[e], curved, force)
    return -1


def second_variation(
    elements: Elements, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, int]:
    """d²/ds² of the internal force along a direction.

    Parameters
    ----------
    elements : Elements
        Of linear tetrahedra that are not averaged.
    u, v : (n_points, 3) array
        State and direction, mm.

    Returns
    -------
    force : (n_points, 3) array
        N.
    inverted : int
        First cell with det F ≤ 0 at u, or −1; the force is then of no use.
    """
    force = np.zeros((elements.n_points, 3))
    inverted = _second_variation(
        elements.cells,
        elements.gradients,
        elements.volumes,
        elements.law,
        elements.constants,
        u,
        v,
        force,
    )
    return force, int(inverted)
