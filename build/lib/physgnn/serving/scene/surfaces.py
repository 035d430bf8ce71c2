"""The part of a body that the page draws: its surfaces."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import IntArray
from physgnn.geometry import TetMesh, boundary_faces
from physgnn.geometry.boundary import region_faces
from physgnn.geometry.regions import BRAIN, region_name


@dataclass(frozen=True, eq=False)
class Shown:
    """Surfaces over a few of the mesh's points.

    Attributes
    ----------
    nodes : (n_shown,) integer array
        The points drawn, ascending.
    faces : mapping of str to (n_faces, 3) integer arrays
        Outward triangles by region name, as indices into `nodes`; "brain" is the
        outer surface of the whole body.
    """

    nodes: IntArray
    faces: Mapping[str, IntArray]

    @classmethod
    def of(cls, mesh: TetMesh) -> "Shown":
        """Return the outer surface and that of every region inside."""
        surfaces = {region_name(BRAIN): boundary_faces(mesh)}
        for label in np.unique(mesh.region[mesh.region > 0]).tolist():
            surfaces[region_name(label)] = region_faces(mesh, label)
        nodes = np.unique(np.concatenate([f.ravel() for f in surfaces.values()]))
        return cls(
            nodes.astype(np.int64),
            {name: np.searchsorted(nodes, f) for name, f in surfaces.items()},
        )
