"""Points of the bone: they don't move with a brain, so they tell of the navigation."""

from dataclasses import dataclass

import numpy as np
import pyvista as pv

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces, boundary_points
from physgnn.geometry.measured import BonePoints
from physgnn.geometry.plausibility import check_same_units, units_by_extent
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.transforms import RAS_TO_LPS
from physgnn.prediction.measured_evidence import LEAST_OFF_BRAIN_MM
from physgnn.registration.measurements.places import SNAP_MM, nearest_places

# No bone of a head is farther from its brain; the chin is about 120 mm.
FARTHEST_MM = 200.0
# A navigation that is farther off has not been registered: it is in other coordinates.
LARGEST_OFFSET_MM = 50.0
# Half of the points of a skull are nearer to the brain than this, but for a face alone.
SKULL_MM = 40.0
# No pointer finds every coordinate of all points as exactly as this again.
MEASURED_MM = 1e-6
KIND = "bone"
LPS = RAS_TO_LPS.diagonal()  # times RAS, and the other way round


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
        If they are in another unit than the brain, inside of it or too far from it, the
        two ends of half of the pairs are more than 50 mm apart, or all are the same.
    """
    surface = mesh.points[boundary_points(mesh)]
    check_same_units(bone.source, surface, "bone points")
    check_same_units(bone.target, surface, "bone points, as the navigation finds them")
    _check_places(mesh, bone)
    if np.abs(bone.displacement).max() < MEASURED_MM:
        raise InputError(
            "bone points must be measured where the navigation finds them now (both "
            "ends of all of them are the same): give what was measured as the second "
            "ends, or leave --bone out"
        )
    apart = float(np.median(np.linalg.norm(bone.displacement, axis=1)))
    if apart > LARGEST_OFFSET_MM:
        raise InputError(
            "bone points must be found near to where the scan has them (half of "
            f"them are {apart:.0f} mm or more away, at most "
            f"{LARGEST_OFFSET_MM:g} mm): check the order or labels of the two ends, "
            "axes (RAS), units (mm) and --initial-transform"
        )


def off_brain(mesh: TetMesh, bone: BonePoints) -> float:
    """Return how far bone points stand off the brain in the scan, in the median, mm.

    Those within the brain's surface stand off by nothing.
    """
    return _BonePlaces.of(mesh, bone.source).off_mm


def can_be_in_lps(mesh: TetMesh, bone: BonePoints) -> bool:
    """Return whether points would lie where bone can be if they were of LPS, too.

    A table of points does not say of which axes it is.
    """
    here, there = (_BonePlaces.of(mesh, axes * bone.source) for axes in (1.0, LPS))
    off_mm = (LEAST_OFF_BRAIN_MM, max(here.off_mm, SKULL_MM))
    return there.possible and off_mm[0] <= there.off_mm <= off_mm[1]


def _check_places(mesh: TetMesh, bone: BonePoints) -> None:
    """Raise InputError if a point cannot be of bone; it names it, or the unit."""
    places = _BonePlaces.of(mesh, bone.source)
    if places.possible:
        return
    for unit, mm in units_by_extent(bone.source, mesh.points).items():
        meant = _BonePlaces.of(mesh, bone.source * mm)
        if meant.possible and meant.off_mm <= SKULL_MM:
            raise InputError(
                "bone points must be in mm, outside of the brain (as they are they lie "
                f"{_extents(places, bone)}, which looks like {unit}): multiply them by "
                f"{mm:g}"
            )
    if places.deep.any():
        raise InputError(
            "bone points must lie outside of the brain (in its depth: "
            f"{_named(bone, places, places.deep)}): check axes (RAS), or give them as "
            "--landmarks"
        )
    raise InputError(
        f"bone points must lie within {FARTHEST_MM:g} mm of the brain (farther: "
        f"{_named(bone, places, places.far)}): check axes (RAS), units (mm) and "
        "--initial-transform"
    )


@dataclass(frozen=True)
class _BonePlaces:
    """How far points are from the brain's surface, mm, and which lie within it."""

    away: FloatArray
    inside: BoolArray

    @classmethod
    def of(cls, mesh: TetMesh, points: FloatArray) -> "_BonePlaces":
        nearest = nearest_places(mesh.points, boundary_faces(mesh), points)[1]
        away = np.linalg.norm(points - nearest, axis=1)
        grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
        inside = np.atleast_1d(grid.find_containing_cell(points)) >= 0
        return cls(away, inside)

    @property
    def deep(self) -> BoolArray:
        return self.inside & (self.away > SNAP_MM)

    @property
    def off_mm(self) -> float:
        return float(np.median(np.where(self.inside, 0.0, self.away)))

    @property
    def far(self) -> BoolArray:
        return self.away > FARTHEST_MM

    @property
    def possible(self) -> bool:
        return not (self.deep | self.far).any()


def _extents(places: _BonePlaces, bone: BonePoints) -> str:
    within = float(np.linalg.norm(np.ptp(bone.source, axis=0)))
    where = "in its depth" if places.deep.any() else f"{places.away.max():.3g} mm away"
    return f"{where}, within {within:.3g} mm of each other"


def _named(bone: BonePoints, places: _BonePlaces, chosen: BoolArray) -> str:
    return ", ".join(
        f"'{bone.labels[i]}' ({places.away[i]:.0f} mm)" for i in np.flatnonzero(chosen)
    )
