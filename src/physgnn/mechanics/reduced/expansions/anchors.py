"""The equilibria to expand about: a load path under the training loads' mean."""

from collections.abc import Iterator

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase, LoadPath


def mean_load_anchors(body: Body, forces: FloatArray, n_anchors: int) -> FloatArray:
    """Return equilibria at equal steps under the mean of some loads.

    The last step is at the largest projection of any of the loads on their mean, in
    energy: λ = f·K₀⁻¹f̄ / f̄·K₀⁻¹f̄. Where the path ends early, by a limit point, the
    last state is repeated.

    Parameters
    ----------
    body : Body
        What's loaded; forces and states are in its mesh's axes.
    forces : (n_loads, n_points, 3) array
        N.
    n_anchors : int
        How many, the rest state not counted.

    Returns
    -------
    (n_anchors, n_points, 3) array
        Displacement, mm.
    """
    mean = forces.mean(axis=0)
    mean[body.fixed] = 0.0
    rest = RestState(body)
    response = rest.solve(mean)
    work = float((mean * response).sum())
    if n_anchors == 0 or work == 0.0:
        return np.zeros((n_anchors, *mean.shape))
    largest = float(np.tensordot(forces, response, axes=2).max()) / work
    nodes = np.flatnonzero(mean.any(axis=1))
    steps = np.arange(1, n_anchors + 1) / n_anchors
    path = LoadPath(nodes, largest * mean[nodes], steps)
    solution = Solver(body).solve(path)
    reached = np.flatnonzero(solution.status == Status.CONVERGED)
    if len(reached) == 0:
        return np.zeros((n_anchors, *mean.shape))
    found: FloatArray = solution.displacement[
        np.minimum(np.arange(n_anchors), reached[-1])
    ]
    return found


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
