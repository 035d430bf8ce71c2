"""Prescribed displacements: surface points moved to measured places."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_indices, checked_numbers
from physgnn.geometry.tetmesh import TetMesh


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement:
    """Points moved by given displacements, in proportion to the load factor.

    Parameters
    ----------
    nodes : (n_held,) integer array
        Points, each named once; none of them may be fixed or carry a force.
    displacement : (n_held, 3) array
        At load factor 1, mm.

    Raises
    ------
    InputError
        If shapes disagree, a node comes twice, or a number is not finite.
    """

    nodes: IntArray
    displacement: FloatArray

    def __post_init__(self) -> None:
        nodes = checked_indices(self.nodes, None, "nodes")
        displacement = checked_numbers(self.displacement, "displacement")
        if nodes.size == 0:
            raise InputError("nodes must be one or more integers (got none)")
        if displacement.shape != (len(nodes), 3):
            raise InputError(
                f"displacement must have shape ({len(nodes)}, 3), one row a node "
                f"(got {displacement.shape})"
            )
        if not np.isfinite(displacement).all():
            raise InputError("displacement must be finite, in mm")
        if len(np.unique(nodes)) < len(nodes):
            raise InputError("every prescribed node must be named once")
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "displacement", displacement)

    def check_against(self, mesh: TetMesh) -> None:
        """Raise InputError if a point is missing from the mesh."""
        checked_indices(self.nodes, mesh.n_points, "prescribed nodes")
