"""Points of the bone: they don't move with a brain, so they tell of the navigation."""

import numpy as np
import pyvista as pv

from physgnn.arrays import BoolArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces, boundary_points
from physgnn.geometry.measured import BonePoints
from physgnn.geometry.plausibility import check_same_units
from physgnn.geometry.tetmesh import TetMesh
from physgnn.registration.measurements.places import SNAP_MM, nearest_places

# No bone of a head is farther from its brain; the chin is about 120 mm.
FARTHEST_MM = 200.0
# A navigation that is farther off has not been registered: it is in other coordinates.
LARGEST_OFFSET_MM = 50.0


KIND = "bone"


def check_bone(mesh: TetMesh, bone: BonePoints) -> None:
    """Check that points can be of bone, in the scan and as the navigation finds them.

    Parameters
    ----------
    mesh : TetMesh
        The brain at rest.
    bone : BonePoints
        What was measured.

    Raises
    ------
    InputError
        If they are in another unit than the brain, inside of it or too far from it, or
        the two ends of half of the pairs are more than 50 mm apart.
    """
    surface = mesh.points[boundary_points(mesh)]
    check_same_units(bone.source, surface, "bone points")
    _check_places(mesh, bone)
    apart = float(np.median(np.linalg.norm(bone.displacement, axis=1)))
    if apart > LARGEST_OFFSET_MM:
        raise InputError(
            "bone points must be found near to where the scan has them (half of "
            f"them are {apart:.0f} mm or more away, at most "
            f"{LARGEST_OFFSET_MM:g} mm): check axes (RAS), units (mm) and "
            "--initial-transform"
        )


def _check_places(mesh: TetMesh, bone: BonePoints) -> None:
    """Raise InputError if a point cannot be of bone; it names it."""
    nearest = nearest_places(mesh.points, boundary_faces(mesh), bone.source)[1]
    away = np.linalg.norm(bone.source - nearest, axis=1)
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    inside = np.atleast_1d(grid.find_containing_cell(bone.source)) >= 0

    def named(chosen: BoolArray) -> str:
        return ", ".join(
            f"'{bone.labels[i]}' ({away[i]:.0f} mm)" for i in np.flatnonzero(chosen)
        )

    deep = inside & (away > SNAP_MM)
    if deep.any():
        raise InputError(
            f"bone points must lie outside of the brain (in its depth: {named(deep)}): "
            "check axes (RAS), or give them as --landmarks"
        )
    far = away > FARTHEST_MM
    if far.any():
        raise InputError(
            f"bone points must lie within {FARTHEST_MM:g} mm of the brain (farther: "
            f"{named(far)}): check axes (RAS), units (mm) and --initial-transform"
        )
