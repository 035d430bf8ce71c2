"""A load in a few numbers, for learners that take no mesh."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.dataset.training_loads import strongest_forces
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.pod_galerkin.pod import leading_modes

Rows = NDArray[np.float32]

N_COMPONENTS = 32
NODAL_COLUMNS = 9  # position, way to the nearest loaded point, force there


@dataclass(frozen=True, eq=False)
class LoadFeatures:
    """Resultant force, its place, and principal components of the training loads.

    Parameters
    ----------
    points : (n_points, 3) array
        At rest, mm.
    components : (n_components, n_points, 3) array
        Orthonormal, by falling share of the training loads.
    """

    points: FloatArray
    components: FloatArray

    @classmethod
    def of(cls, store: Store, samples: IntArray) -> "LoadFeatures":
        """Return the features that fit the loads of these (path, level) samples."""
        forces = strongest_forces(store, samples)
        n_components = min(N_COMPONENTS, len(forces))
        return cls(store.mesh.points, leading_modes(forces, n_components))

    def of_case(self, case: LoadCase) -> Rows:
        """Return the load's features, (6 + n_components,), N and mm."""
        size = np.linalg.norm(case.forces, axis=1)
        place = size @ self.points[case.nodes] / max(size.sum(), np.finfo(float).tiny)
        shares = np.tensordot(self.components[:, case.nodes], case.forces, axes=2)
        resultant = case.forces.sum(axis=0)
        return np.concatenate([resultant, place, shares]).astype(np.float32)

    def of_nodes(self, case: LoadCase, nodes: IntArray) -> Rows:
        """Return what sets one node apart from another under the same load.

        Returns
        -------
        (n_nodes, 9) array
            Position and way to the nearest loaded point, mm; the force there, N.
        """
        places = self.points[nodes]
        _, nearest = cKDTree(self.points[case.nodes]).query(places)
        way = self.points[case.nodes][nearest] - places
        columns = np.concatenate([places, way, case.forces[nearest]], axis=1)
        return columns.astype(np.float32)
