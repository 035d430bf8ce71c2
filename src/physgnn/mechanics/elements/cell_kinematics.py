"""Kinematics of a linear tetrahedron: F, its inverse transpose, change of volume."""

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.geometry.regions import VENTRICLE
from physgnn.geometry.tetmesh import TetMesh, shape_gradients


def deformation_gradient(mesh: TetMesh, displacement: FloatArray) -> FloatArray:
    """F = I + Σ_a u_a ⊗ ∂N_a/∂X.

    Parameters
    ----------
    mesh : TetMesh
    displacement : (n_points, 3) array
        mm.

    Returns
    -------
    (n_cells, 3, 3) array
    """
    current = (mesh.points + displacement)[mesh.cells]
    deformed = (current[:, 1:] - current[:, :1]).transpose(0, 2, 1)
    F: FloatArray = deformed @ shape_gradients(mesh.points, mesh.cells)[:, 1:]
    return F


def volume_change_range(mesh: TetMesh, displacement: FloatArray) -> tuple[float, float]:
    """Return the smallest and the largest J = det F over cells of tissue; u in mm.

    Ventricles hold fluid that comes and goes: their cells count only where they are
    turned inside out, or where there are no others.
    """
    J = np.linalg.det(deformation_gradient(mesh, displacement))
    counted = (mesh.region != VENTRICLE) | (J <= 0.0)
    J = J[counted] if counted.any() else J
    return float(J.min()), float(J.max())


@njit(cache=True, inline="always")
def inverse_transpose(F, H):  # type: ignore[no-untyped-def]
    """Fill H = F⁻ᵀ and return J = det F; H is left as it is if J ≤ 0."""
    c00 = F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1]
    c01 = F[1, 2] * F[2, 0] - F[1, 0] * F[2, 2]
    c02 = F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0]
    J = F[0, 0] * c00 + F[0, 1] * c01 + F[0, 2] * c02
    if J > 0.0:
        s = 1.0 / J
        H[0, 0], H[0, 1], H[0, 2] = s * c00, s * c01, s * c02
        H[1, 0] = s * (F[0, 2] * F[2, 1] - F[0, 1] * F[2, 2])
        H[1, 1] = s * (F[0, 0] * F[2, 2] - F[0, 2] * F[2, 0])
        H[1, 2] = s * (F[0, 1] * F[2, 0] - F[0, 0] * F[2, 1])
        H[2, 0] = s * (F[0, 1] * F[1, 2] - F[0, 2] * F[1, 1])
        H[2, 1] = s * (F[0, 2] * F[1, 0] - F[0, 0] * F[1, 2])
        H[2, 2] = s * (F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0])
    return J


@njit(cache=True, inline="always")
def kinematics(cell, gradient, rest, u, F, H):  # type: ignore[no-untyped-def]
    """Fill F and H = F⁻ᵀ of one cell; return J = det F (H is left if J ≤ 0).

    `rest` is the diagonal of F where u is nothing: 1, or 1/g once the cell has grown.
    """
    o, p, q, r = cell[0], cell[1], cell[2], cell[3]
    for i in range(3):
        # Relative to the first corner, as the gradients of all four add up to nothing.
        a, b, c = u[p, i] - u[o, i], u[q, i] - u[o, i], u[r, i] - u[o, i]
        for j in range(3):
            F[i, j] = a * gradient[1, j] + b * gradient[2, j] + c * gradient[3, j]
        F[i, i] += rest
    return inverse_transpose(F, H)


@njit(cache=True)
def volume_changes(cells, gradients, rest, u, J, cofactors):  # type: ignore[no-untyped-def]
    """Fill J and J F⁻ᵀ of every cell; return the first inverted cell or −1."""
    F, H = np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(cells)):
        J[e] = kinematics(cells[e], gradients[e], rest[e], u, F, H)
        if not J[e] > 0.0:
            return e
        for i in range(3):
            for j in range(3):
                cofactors[e, i, j] = J[e] * H[i, j]
    return -1
