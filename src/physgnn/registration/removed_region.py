"""A brain without the tissue that was resected, and what was measured of the rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.measured import BonePoints, Landmarks, PointPairs
from physgnn.geometry.regions import BRAIN, region_label, region_name
from physgnn.geometry.tetmesh import TetMesh, without_unused_points
from physgnn.mechanics.resection import remove_region
from physgnn.registration.causes import CAVITY

# A point so near to the wall counts as of the wall: less than it is placed by hand to.
WALL_MM = 1.0


@dataclass(frozen=True, eq=False)
class Resected:
    """What is left of a brain and what is not.

    Attributes
    ----------
    remaining : TetMesh
        The rest state of what is left; the point set ``cavity`` is the wall.
    removed : TetMesh
        What was taken out, at rest.
    name : str
        Of the region.
    """

    remaining: TetMesh
    removed: TetMesh
    name: str

    def check_measured(self, measured: Sequence[Any]) -> None:
        """Raise InputError if pairs or landmarks are of removed tissue; it names them.

        Parameters
        ----------
        measured : sequence of measurements
            In the space of the mesh; surfaces may lie anywhere.
        """
        for one in measured:
            if not isinstance(one, PointPairs) or isinstance(one, BonePoints):
                continue
            to_wall = _distance(self.remaining, one.source)
            gone = (to_wall > WALL_MM) & (_distance(self.removed, one.source) < to_wall)
            if gone.any():
                kind = "landmarks" if isinstance(one, Landmarks) else "points"
                names = ", ".join(
                    f"'{one.labels[i]}' ({to_wall[i]:.1f} mm from the wall)"
                    for i in np.flatnonzero(gone).tolist()
                )
                raise InputError(
                    f"{kind} in the {self.name} that was removed have no place after "
                    f"it: leave out {names}, or --remove"
                )


def resected(mesh: TetMesh, region: str) -> Resected:
    """Take a region out of a mesh.

    Parameters
    ----------
    mesh : TetMesh
        Before the resection.
    region : str
        The region, by name or number.

    Raises
    ------
    InputError
        If there is no such region, or it is the brain itself.
    """
    label = region_label(region)
    if label is None or not (mesh.region == label).any():
        there = ", ".join(region_name(i) for i in np.unique(mesh.region).tolist())
        raise InputError(
            f"--remove must name a region of the mesh, {there} (got '{region}')"
        )
    if label == BRAIN:
        raise InputError(
            "--remove must name a part of the brain, such as tumour (got brain, which "
            "is all the rest)"
        )
    remaining, index = remove_region(mesh, label)
    gone = mesh.region == label
    wall = index[np.unique(mesh.cells[gone])]
    removed, _ = without_unused_points(
        mesh.points, mesh.cells[gone], mesh.region[gone], {}
    )
    remaining = remaining.with_point_sets(**{CAVITY: np.unique(wall[wall >= 0])})
    return Resected(remaining, removed, region_name(label))


def _distance(mesh: TetMesh, points: FloatArray) -> FloatArray:
    """Return how far points are from the tissue of a mesh, mm; 0 inside."""
    import pyvista as pv

    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    found: Any = grid.find_closest_cell(points, return_closest_point=True)
    distance: FloatArray = np.linalg.norm(points - np.asarray(found[1]), axis=1)
    return distance
