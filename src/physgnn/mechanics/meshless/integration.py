"""Background integration: points inside the tetrahedra, and what acts on them.

The cells only say where to integrate and how much each point counts; the displacement
comes from moving least squares. Four points a cell are the rule of degree 2 of Keast
1986, Comput. Methods Appl. Mech. Engrg. 55, 339–348.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry.tetmesh import TetMesh

NEAR, FAR = (5 - 5**0.5) / 20, (5 + 3 * 5**0.5) / 20
BARYCENTRIC = {
    1: np.full((1, 4), 0.25),
    4: np.full((4, 4), NEAR) + (FAR - NEAR) * np.eye(4),
}


@dataclass(frozen=True, eq=False)
class IntegrationPoints:
    """What the kernels need at every integration point.

    Attributes
    ----------
    start, nodes : integer arrays
        The points that act on it: see `physgnn.mechanics.meshless.supports.Neighbours`.
    gradients : (n_pairs, 3) array
        ∂φ_j/∂X, 1/mm.
    per_cell : int
        Integration points a cell; those of cell e are e·per_cell and the next.
    """

    start: IntArray
    nodes: NDArray[np.int32]
    gradients: FloatArray
    per_cell: int


def integration_places(mesh: TetMesh, per_cell: int) -> FloatArray:
    """Return where to integrate, (n_cells × per_cell, 3), mm."""
    corners = mesh.points[mesh.cells]
    places: FloatArray = np.einsum("qa,eai->eqi", BARYCENTRIC[per_cell], corners)
    return places.reshape(-1, 3)
