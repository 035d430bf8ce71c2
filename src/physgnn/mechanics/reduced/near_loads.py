"""A network's answer near a force on few points, put right by the equations there.

A force on a single point strains the cells round it far beyond what a network has seen;
one that is spread over a patch does not.
"""

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.geometry.mesh_topology import points_within
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.submesh_solve import settle

FEW = 3  # loaded points
LEAST_REACH = 3  # edges


class NearLoads:
    """Settles answers of one body.

    Parameters
    ----------
    body : Body
        What is loaded. Answers with averaged elements are left as they are.
    reach : int
        Edges from the load to the end of the patch; 0 leaves all answers as they are.
    """

    def __init__(self, body: Body, reach: int) -> None:
        self._body, self._reach = body, reach

    def settled(self, load_case: LoadCase, displacement: FloatArray) -> FloatArray:
        """Return an answer (n_points, 3), mm, with the cells near the load at rest.

        It is the one given if the load acts on many points, or if no equilibrium is
        found.
        """
        if not self._acts_on_few(load_case):
            return displacement
        force = load_case.on_points(self._body.mesh.n_points)
        loaded = np.flatnonzero(force.any(axis=1))
        # Where an outer cell is turned over, a smaller patch may still do.
        for reach in range(self._reach, min(self._reach, LEAST_REACH) - 1, -1):
            points = np.flatnonzero(points_within(self._body.mesh, loaded, reach))
            found = settle(self._body, points, displacement, force)
            if found is not None:
                return found
        return displacement

    def _acts_on_few(self, load_case: LoadCase) -> bool:
        n_loaded = int(load_case.forces.any(axis=1).sum())
        settles = self._reach > 0 and self._body.element == DEFAULT_ELEMENT
        return settles and 0 < n_loaded <= FEW
