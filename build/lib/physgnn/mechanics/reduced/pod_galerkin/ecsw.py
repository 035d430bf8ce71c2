"""Hyper-reduction: a few weighted cells that do the work of all of them.

Energy-conserving sampling and weighting (ECSW: Farhat, Avery, Chapman & Cortial 2014,
Int. J. Numer. Meth. Eng. 98, section 4): weights w ≥ 0, most of them zero, such that
Σ w_e Φᵀf_e = Σ Φᵀf_e, to a tolerance, for the modes Φ and the cells' forces f_e in
training states. Since no weight is negative, the sum is still the energy of a body.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.elements.tet4 import Elements, internal_force

AT_ONCE = 8  # cells added before the weights are fitted anew


def cell_works(
    elements: Elements, u: FloatArray, modes: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return what the force of every cell does along every mode.

    Parameters
    ----------
    elements : Elements
        Not averaged.
    u : (n_points, 3) array
        A state without inverted cells, mm.
    modes : (n_modes, n_points, 3) float32 array

    Returns
    -------
    (n_modes, n_cells) float32 array
        Its sum over cells is Φᵀ f_int(u).
    """
    corners = np.arange(elements.cells.size, dtype=np.int32)
    loose = replace(
        elements, cells=corners.reshape(-1, 4), n_points=elements.cells.size
    )
    forces, _ = internal_force(loose, u[elements.cells.ravel()])
    forces32 = forces.reshape(len(elements.cells), 12).astype(np.float32)
    works = np.empty((len(modes), len(elements.cells)), dtype=np.float32)
    for work, mode in zip(works, modes, strict=True):
        work[:] = (mode[elements.cells].reshape(-1, 12) * forces32).sum(axis=1)
    return works


def weigh_cells(works: NDArray[np.float32], tolerance: float) -> FloatArray:
    """Return weights ≥ 0 under which few cells do the work of all.

    Nonnegative least squares (Lawson & Hanson 1974, chapter 23), stopped early.

    Parameters
    ----------
    works : (n_works, n_cells) float32 array
        From `cell_works`, of the training states.
    tolerance : float
        Relative residual to stop at.
    """
    total = works.sum(axis=1, dtype=np.float64)
    weights, missing = np.zeros(works.shape[1]), total
    limit = tolerance * float(np.linalg.norm(total))
    while np.linalg.norm(missing) > limit:
        gain = missing.astype(np.float32) @ works
        gain[weights > 0] = -np.inf
        best = np.argpartition(gain, -AT_ONCE)[-AT_ONCE:]
        best = best[gain[best] > 0]
        active = np.union1d(np.flatnonzero(weights), best)
        before = np.linalg.norm(missing)
        weights = _fitted(works, total, weights, active)
        used = np.flatnonzero(weights)
        missing = total - works[:, used] @ weights[used]
        if len(best) == 0 or np.linalg.norm(missing) >= before * (1 - 1e-6):
            break
    return weights


def _fitted(
    works: NDArray[np.float32], total: FloatArray, weights: FloatArray, active: IntArray
) -> FloatArray:
    """Fit the active weights by least squares; those that would turn negative leave."""
    while True:
        columns = works[:, active].astype(np.float64)
        gram = columns.T @ columns
        gram[np.diag_indices(len(gram))] *= 1 + 1e-10
        wanted = np.linalg.solve(gram, columns.T @ total)
        if (wanted > 0).all():
            fitted = np.zeros_like(weights)
            fitted[active] = wanted
            return fitted
        # Go towards the fit until the first weight reaches zero, and let it go.
        now, shrinks = weights[active], wanted <= 0
        part = (now[shrinks] / np.maximum(now[shrinks] - wanted[shrinks], 1e-300)).min()
        weights = weights.copy()
        weights[active] = now + part * (wanted - now)
        gone = shrinks & (weights[active] <= 1e-12 * weights.max(initial=0.0))
        weights[active[gone]] = 0.0
        active = active[~gone]
