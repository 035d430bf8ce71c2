"""The equilibria to expand about: under the mean of expected loads, or of clusters."""

from collections.abc import Iterator

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.reduced.expansions.load_clusters import (
    clusters,
    energy_coordinates,
    third_order,
)
from physgnn.mechanics.reduced.submodels.near_loads import FEW

LEVELS = np.arange(1, 11) / 10  # a load is expected at each of these factors
LOADS_A_CLUSTER = 5  # fewer would have states of their own, and be told too well
BETTER = 0.7  # of Σ d³: what clusters must leave at most, to be worth their solutions
STEPS = np.arange(1, 4) / 3  # to the mean of a cluster


def expected_anchors(body: Body, forces: FloatArray, n_anchors: int) -> FloatArray:
    """Return equilibria near loads that are to be expected.

    Loads of one kind lie round their mean: the states are at equal steps under it, the
    last where any load reaches along it. Loads in several places do not: where clusters
    of them leave much less of the third order, the states are under the clusters' means
    (`physgnn.mechanics.reduced.expansions.load_clusters`).

    Parameters
    ----------
    body : Body
        What's loaded; forces and states are in its mesh's axes.
    forces : (n_loads, n_points, 3) array
        Each load at its strongest, N.
    n_anchors : int
        How many, the rest state not counted.

    Returns
    -------
    (n_anchors, n_points, 3) array
        Displacement, mm. Where a load path ends early, by a limit point, its last state
        is repeated, or is that of its cluster; zero where there is none.
    """
    forces = forces.copy()
    forces[:, body.fixed] = 0.0
    if n_anchors == 0 or not forces.any():
        return np.zeros((n_anchors, *forces.shape[1:]))
    strongest = energy_coordinates(RestState(body), forces)
    steps = _steps_along_mean(strongest, n_anchors)
    if _may_cluster(forces, n_anchors):
        loads = (LEVELS[:, None, None] * strongest).reshape(-1, len(forces))
        weights = clusters(loads, n_anchors)
        left = third_order(loads, weights @ loads)
        if left < BETTER * third_order(loads, steps[:, None] * strongest.mean(axis=0)):
            shares = weights.reshape(len(weights), len(LEVELS), len(forces))
            means = np.tensordot(
                np.einsum("kln,l->kn", shares, LEVELS), forces, axes=(1, 0)
            )
            return _under_each(body, means, n_anchors)
    return _along(body, forces.mean(axis=0), steps)


def _may_cluster(forces: FloatArray, n_anchors: int) -> bool:
    """Return whether there are loads enough for clusters, and states for their places.

    Under a force on few points the cells round it are solved (`near_loads`), not those
    round another place that a state has loaded: it must not load another.
    """
    if len(forces) < LOADS_A_CLUSTER * n_anchors:
        return False
    places = np.unique(forces.any(axis=2), axis=0)
    return len(places) <= n_anchors or bool(places.sum(axis=1).min() > FEW)


def _steps_along_mean(loads: FloatArray, n_steps: int) -> FloatArray:
    """Return load factors of the mean, up to the largest projection of a load on it.

    λ = f·K₀⁻¹f̄ / f̄·K₀⁻¹f̄, here in coordinates; zeros if the mean does no work.
    """
    mean = loads.mean(axis=0)
    work = float(mean @ mean)
    if work <= np.finfo(np.float64).eps * float((loads**2).sum(axis=1).max()):
        return np.zeros(n_steps)
    return float((loads @ mean).max()) / work * np.arange(1, n_steps + 1) / n_steps


def _along(body: Body, mean: FloatArray, steps: FloatArray) -> FloatArray:
    """Return states under one load at some factors, (n_steps, n_points, 3)."""
    if not steps.any():
        return np.zeros((len(steps), *mean.shape))
    nodes = np.flatnonzero(mean.any(axis=1))
    path = LoadPath(nodes, steps[-1] * mean[nodes], steps / steps[-1])
    states = _reached(Solver(body), path)
    if len(states) == 0:
        return np.zeros((len(steps), *mean.shape))
    return states[np.minimum(np.arange(len(steps)), len(states) - 1)]


def _under_each(body: Body, means: FloatArray, n_anchors: int) -> FloatArray:
    """Return the state under each of some loads, (n_anchors, n_points, 3)."""
    found, solver = np.zeros((n_anchors, *means.shape[1:])), Solver(body)
    for state, mean in zip(found, means, strict=False):
        nodes = np.flatnonzero(mean.any(axis=1))
        states = _reached(solver, LoadPath(nodes, mean[nodes], STEPS))
        if len(states):
            state[:] = states[-1]
    return found


def _reached(solver: Solver, path: LoadPath) -> FloatArray:
    """Return the displacements of a path up to where it ends."""
    solution = solver.solve(path)
    states: FloatArray = solution.displacement[solution.status == Status.CONVERGED]
    return states


def loads_held_by(body: Body, states: FloatArray) -> Iterator[LoadCase]:
    """Yield the load that each state is in equilibrium with, if there is any.

    Parameters
    ----------
    body : Body
    states : (n_states, n_points, 3) array
        Displacements, mm; one that inverts a cell holds no load.
    """
    free = body.pattern.free
    for state in states:
        force, inverted = internal_force(body.elements, state)
        if inverted < 0 and force[free].any():
            yield LoadCase(free, force[free])
