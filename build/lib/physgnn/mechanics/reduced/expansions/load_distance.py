"""How far loads are from one another, measured by the work they do at rest.

d(f, g)² = (f − g)·K₀⁻¹(f − g): a force that moves the body a lot counts for much. Only
the part of K₀⁻¹ at the loaded points is needed.
"""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.linear_elasticity import RestState

COLUMNS_AT_ONCE = 48


class LoadDistance:
    """Makes of forces on some points coordinates whose distances are those of energy.

    Parameters
    ----------
    body : Body
        What's loaded.
    nodes : integer array
        Points that carry a force in some load.
    """

    def __init__(self, body: Body, nodes: IntArray) -> None:
        self.nodes = np.setdiff1d(nodes, body.fixed)
        rest = RestState(body)
        n = 3 * len(self.nodes)
        compliance = np.empty((n, n))
        for first in range(0, n, COLUMNS_AT_ONCE):
            some = np.arange(first, min(first + COLUMNS_AT_ONCE, n))
            unit = np.zeros((len(some), body.mesh.n_points, 3))
            unit[np.arange(len(some)), self.nodes[some // 3], some % 3] = 1.0
            response = rest.solve(unit)[:, self.nodes]
            compliance[some] = response.reshape(len(some), -1)
        self._root = np.linalg.cholesky((compliance + compliance.T) / 2)

    def coordinates(self, forces: FloatArray) -> FloatArray:
        """Return (n_loads, 3 · n_nodes) for forces (n_loads, n_nodes, 3) in N."""
        flat = forces.reshape(len(forces), len(self._root))
        coordinates: FloatArray = flat @ self._root
        return coordinates


def farthest(coordinates: FloatArray, n_chosen: int) -> IntArray:
    """Choose points one by one, each the farthest from the origin and those before.

    Returns fewer where there are no more different points.
    """
    chosen: list[int] = []
    distance = np.linalg.norm(coordinates, axis=1)
    while len(chosen) < n_chosen and distance.max(initial=0.0) > 0.0:
        chosen.append(int(distance.argmax()))
        apart = np.linalg.norm(coordinates - coordinates[chosen[-1]], axis=1)
        distance = np.minimum(distance, apart)
    return np.array(chosen, dtype=np.int64)
