"""Loads that lie near one another in energy, and the means of such clusters.

An expansion of second order leaves an error of third order in the distance d between a
load and the one it is expanded about. So clusters are sought with a small sum of d³:
Lloyd's algorithm (1982, IEEE Trans. Inf. Theory 28, 129–137) with distances as weights
of a mean, which makes of its squares cubes.
"""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.reduced.expansions.load_distance import farthest

LOADS_AT_ONCE = 48
ROUNDS = 100


def energy_coordinates(rest: RestState, forces: FloatArray) -> FloatArray:
    """Return coordinates of loads whose distances are those of energy.

    d(f, g)² = (f − g)·K₀⁻¹(f − g). They are linear in the load.

    Parameters
    ----------
    rest : RestState
        Of the body that is loaded.
    forces : (n_loads, n_points, 3) array
        N.

    Returns
    -------
    (n_loads, n_loads) array
        √(N mm).
    """
    flat = forces.reshape(len(forces), -1)
    work = np.empty((len(forces), len(forces)))
    for first in range(0, len(forces), LOADS_AT_ONCE):
        some = slice(first, first + LOADS_AT_ONCE)
        response = rest.solve(forces[some])
        work[some] = response.reshape(len(response), -1) @ flat.T
    values, vectors = np.linalg.eigh((work + work.T) / 2)
    coordinates: FloatArray = vectors * np.sqrt(np.maximum(values, 0.0))
    return coordinates


def clusters(loads: FloatArray, n_clusters: int) -> FloatArray:
    """Return how much of each load is in the mean of each cluster; no load is one, too.

    Parameters
    ----------
    loads : (n_loads, n) array
        Coordinates of loads, distances apart.
    n_clusters : int
        How many, besides those loads that lie nearest to none at all.

    Returns
    -------
    (n_found, n_loads) array
        Rows sum to 1. There are fewer if fewer loads differ.
    """
    chosen = farthest(loads, n_clusters)
    weights = np.eye(len(loads))[chosen]
    for _ in range(ROUNDS):
        nearest, distance = _nearest(loads, weights @ loads)
        before = weights.copy()
        for k in range(len(chosen)):
            mine = distance * (nearest == k + 1)
            if mine.any():  # else the mean is its one load, or has none
                weights[k] = mine / mine.sum()
        if np.allclose(weights, before, rtol=0, atol=1e-6):
            break
    return weights


def third_order(loads: FloatArray, centres: FloatArray) -> float:
    """Return Σ d³ of loads from the nearest of some centres, or from no load."""
    return float((_nearest(loads, centres)[1] ** 3).sum())


def _nearest(loads: FloatArray, centres: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return which centre is nearest to each load, 0 for no load, and how far it is."""
    known = np.concatenate([np.zeros((1, loads.shape[1])), centres])
    apart = np.stack([np.linalg.norm(loads - centre, axis=1) for centre in known])
    nearest = apart.argmin(axis=0)
    return nearest, np.asarray(apart.min(axis=0))
