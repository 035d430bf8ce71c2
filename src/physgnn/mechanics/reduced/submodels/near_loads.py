"""A network's prediction corrected near a force on few points, by a submesh solve.

A force on a single point strains the cells round it far beyond what a network has seen;
one that is spread over a patch does not.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.geometry.mesh_topology import points_within
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.submodels.submesh_solve import solve_submesh

FEW = 3  # loaded points
LEAST_HOPS = 3  # edges


class NearLoads:
    """Corrects predictions on one body.

    Parameters
    ----------
    body : Body
        What is loaded. Predictions with averaged elements stay as they are.
    k_hops : int
        Edges from the load to the end of the submesh; 0 leaves predictions as they are.
    """

    def __init__(self, body: Body, k_hops: int) -> None:
        self._body, self._k_hops = body, k_hops

    def corrected(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Return a prediction (n_points, 3), mm, with cells near the load in balance.

        It is the one given if the load acts on many points, or if no equilibrium is
        found, or only one that is farther off than the prediction goes: then cells have
        snapped through to another.
        """
        if not self._acts_on_few(load_case):
            return displacement
        force = load_case.on_points(self._body.mesh.n_points)
        loaded = np.flatnonzero(force.any(axis=1))
        farthest = np.linalg.norm(displacement, axis=1).max()
        # Where an outer cell is turned over, a smaller submesh may still do.
        for k_hops in range(self._k_hops, min(self._k_hops, LEAST_HOPS) - 1, -1):
            points = np.flatnonzero(points_within(self._body.mesh, loaded, k_hops))
            found = solve_submesh(self._body, points, displacement, force)
            if found is None:
                continue
            if np.linalg.norm(found - displacement, axis=1).max() <= farthest:
                return found
        return displacement

    def _acts_on_few(self, load_case: LoadCase) -> bool:
        n_loaded = int(load_case.forces.any(axis=1).sum())
        solves = self._k_hops > 0 and self._body.element == DEFAULT_ELEMENT
        return solves and 0 < n_loaded <= FEW
