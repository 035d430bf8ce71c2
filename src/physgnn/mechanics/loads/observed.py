"""A load case of which it was seen how some points moved under it."""

from dataclasses import dataclass

from physgnn.arrays import IntArray
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement


@dataclass(frozen=True, eq=False)
class ObservedLoadCase(LoadCase):
    """Nodal forces, and the displacement of the points that are seen.

    Parameters
    ----------
    nodes, forces
        Of a `LoadCase`.
    observed : PrescribedDisplacement
        Which points were seen, and how they moved, mm.
    """

    observed: PrescribedDisplacement

    def check_against(self, mesh: TetMesh, fixed: IntArray) -> None:
        """Raise InputError if a node, loaded or seen, does not fit the mesh."""
        super().check_against(mesh, fixed)
        self.observed.check_against(mesh)
