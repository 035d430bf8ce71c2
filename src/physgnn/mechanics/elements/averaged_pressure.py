"""Averaged change of volume: the cure for locking at ν ≥ 0.49.

A linear tetrahedron near incompressibility can hardly deform: one volume constraint
a cell is more than its points have freedom for. Here the cost of a change of volume
is charged to the average over groups of cells instead,

    W = Σ_e V_e W̃(F_e) + Σ_g V_g ½ κ (ln J̄_g)²,    V_g J̄_g = Σ_e w V_e J_e,

where κ is the law's first constant and W̃ the law without it. A group is a point with
a quarter of every cell around it, and a point on an interface has a group for each
region, so pressure may jump there. Forces stay the exact derivative of an energy and
the tangent stays symmetric.

That tangent, K = K̃ + Bᵀ D B with B = ∂J̄/∂u and D diagonal, couples neighbours of
neighbours. K̃ alone couples only neighbours. So the pressures are kept as unknowns:

    | K̃      Bᵀ√D | |u|   |f|
    | √D B   −1   | |q| = |0|

has the same u as K u = f, and a factor of less than half the size. It has a negative
eigenvalue a group, and no other, where K is positive definite, since eigenvalues keep
their signs in block elimination.

Source: average nodal pressure, Bonet & Burton 1998, Commun. Numer. Meth. Engng 14,
437–449; for brain shift: Joldes, Wittek & Miller 2009, Commun. Numer. Meth. Engng 25.
Block elimination: Benzi, Golub & Liesen 2005, Acta Numerica 14, 1–137; signs of
eigenvalues: Haynsworth 1968, Linear Algebra Appl. 1, 73–81.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import TetMesh


@dataclass(frozen=True, eq=False)
class Averaging:
    """Groups of cells that share one change of volume.

    Attributes
    ----------
    groups : (n_cells, 4) int32 array
        The groups a cell gives a quarter of itself to.
    volumes : (n_groups,) array
        V_g, mm³.
    kappa : (n_groups,) array
        κ, MPa.
    start, points : int32 arrays
        The points of group g's cells are points[start[g]:start[g + 1]], ascending.
    place : (n_cells, 4, 4) int32 array
        Where in `points` the cell's group s has the cell's corner a.
    """

    groups: NDArray[np.int32]
    volumes: FloatArray
    kappa: FloatArray
    start: NDArray[np.int32]
    points: NDArray[np.int32]
    place: NDArray[np.int32]


def make_averaging(mesh: TetMesh, kappa: FloatArray) -> Averaging:
    """Group cells about points, region by region; `kappa` is (n_cells,), MPa."""
    _, label = np.unique(mesh.region, return_inverse=True)
    keys = mesh.cells + mesh.n_points * label.astype(np.int64)[:, None]
    _, groups = np.unique(keys, return_inverse=True)
    groups = groups.reshape(mesh.cells.shape).astype(np.int32)
    n_groups = int(groups.max()) + 1
    volumes = group_volumes(groups, mesh.cell_volumes)
    kappa_of_group = np.zeros(n_groups)
    kappa_of_group[groups] = kappa[:, None]
    corners_of_groups = (
        groups[:, :, None].astype(np.int64) * mesh.n_points + mesh.cells[:, None]
    )
    pairs, place = np.unique(corners_of_groups, return_inverse=True)
    start = np.searchsorted(pairs, np.arange(n_groups + 1) * mesh.n_points)
    return Averaging(
        groups,
        volumes,
        kappa_of_group,
        start.astype(np.int32),
        (pairs % mesh.n_points).astype(np.int32),
        place.reshape(corners_of_groups.shape).astype(np.int32),
    )


def group_volumes(groups: NDArray[np.int32], volumes: FloatArray) -> FloatArray:
    """Return V_g, a quarter of every cell in the group, (n_groups,), mm³."""
    found = np.zeros(int(groups.max()) + 1)
    np.add.at(found, groups, volumes[:, None] / 4)
    return found


@njit(cache=True)
def mean_volume_change(J, volumes, groups, group_volumes):  # type: ignore[no-untyped-def]
    """Return J̄ of every group."""
    mean = np.zeros(len(group_volumes))
    for e in range(len(groups)):
        for g in groups[e]:
            mean[g] += volumes[e] * J[e] / groups.shape[1]
    return mean / group_volumes


@njit(cache=True)
def cell_pressures(mean, kappa, groups):  # type: ignore[no-untyped-def]
    """Return p_e = Σ w p_g, p_g = κ ln J̄ / J̄, of every cell, MPa."""
    part = kappa * np.log(mean) / mean / groups.shape[1]
    pressure = np.zeros(len(groups))
    for e in range(len(groups)):
        for g in groups[e]:
            pressure[e] += part[g]
    return pressure


@njit(cache=True)
def volume_gradients(  # type: ignore[no-untyped-def]
    cofactors, volumes, gradients, groups, group_volumes, place, n_places
):
    """Return ∂J̄_g/∂u for every point of every group, (n_places, 3), 1/mm.

    `cofactors` is J_e F_e⁻ᵀ, (n_cells, 3, 3).
    """
    B, of_cell = np.zeros((n_places, 3)), np.empty((4, 3))
    for e in range(len(groups)):
        for a in range(4):
            for i in range(3):
                of_cell[a, i] = 0.0
                for j in range(3):
                    of_cell[a, i] += cofactors[e, i, j] * gradients[e, a, j]
        for g in range(4):
            scale = volumes[e] / (4 * group_volumes[groups[e, g]])
            for a in range(4):
                for i in range(3):
                    B[place[e, g, a], i] += scale * of_cell[a, i]
    return B


def pressure_rows(
    averaging: Averaging, mean: FloatArray, B: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what the tangent has in the rows of the pressures.

    Parameters
    ----------
    averaging : Averaging
    mean : (n_groups,) array
        J̄_g.
    B : (n_places, 3) array
        ∂J̄_g/∂u, 1/mm.

    Returns
    -------
    coupling : (n_places, 3) array
        √|D_g| ∂J̄_g/∂u, D_g = V_g p'_g, p' = κ (1 − ln J̄) / J̄².
    diagonal : (n_groups,) array
        −1, or 1 where D_g is not positive: a mean volume that has grown e-fold.
    """
    slope = averaging.kappa * (1 - np.log(mean)) / mean**2
    D = averaging.volumes * slope
    coupling = np.repeat(np.sqrt(np.abs(D)), np.diff(averaging.start))[:, None] * B
    return coupling, np.where(D > 0, -1.0, 1.0)
