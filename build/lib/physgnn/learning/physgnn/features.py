"""What PhysGNN is told of every point: its kind and the force on it."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadCase

TUMOUR_REGION = 1
FIXED, TUMOUR, BRAIN = 0.0, 0.4, 1.0


def physical_property(mesh: TetMesh, fixed: IntArray) -> FloatArray:
    """Return 0 for fixed points, 0.4 for any point of a tumour cell, 1 elsewhere.

    Values as published (Salehi & Giannacopoulos 2022); a point that is both is fixed.

    Returns
    -------
    (n_points,) array
    """
    kind = np.full(mesh.n_points, BRAIN)
    kind[mesh.cells[mesh.region == TUMOUR_REGION].ravel()] = TUMOUR
    kind[fixed] = FIXED
    return kind


def force_features(forces: FloatArray) -> FloatArray:
    """Return Fx, Fy, Fz, ρ, φ, θ of every force.

    ρ = |F|, φ = arccos(Fz/ρ), θ = arcsin(Fy/(ρ sin φ)), as published; no force gives
    zeros, and a force along z gives θ = 0.

    Parameters
    ----------
    forces : (n, 3) array
        N.

    Returns
    -------
    (n, 6) array
        N and radians.
    """
    size = np.linalg.norm(forces, axis=1)
    across = np.hypot(forces[:, 0], forces[:, 1])  # ρ sin φ
    phi = np.arccos(_ratio(forces[:, 2], size, empty=1.0))
    theta = np.arcsin(_ratio(forces[:, 1], across, empty=0.0))
    return np.column_stack([forces, size, phi, theta])


def load_features(load_case: LoadCase, n_points: int) -> FloatArray:
    """Return the six force columns on every point, (n_points, 6)."""
    columns = np.zeros((n_points, 6))
    columns[load_case.nodes] = force_features(load_case.forces)
    return columns


def _ratio(part: FloatArray, whole: FloatArray, *, empty: float) -> FloatArray:
    """Return part / whole within [−1, 1], and ``empty`` where whole is zero."""
    ratio = np.full(len(whole), empty)
    np.divide(part, whole, out=ratio, where=whole > 0)
    return ratio.clip(-1.0, 1.0)
