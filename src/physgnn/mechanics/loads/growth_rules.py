"""Which tissue swells or contracts, described so that it fits any mesh."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import BoolArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.regions import region_label, region_name
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.growth import VolumeGrowth, check_volume_ratio


@dataclass(frozen=True)
class GrowthIn:
    """Swelling or contraction of a region, a point set, or tissue near a region.

    Attributes
    ----------
    volume_ratio : float
        Stress-free volume over that at rest, 0.5 to 2.
    region : str or None
        Name or number of the region that grows.
    points : str or None
        A point set; the cells grow whose corners are all in it. With a region, those
        of the region.
    near : str or None
        Name or number of a region, which does not grow for it: of all else that is
        named, or the whole body, only what lies near it grows.
    within_mm : float
        How near.

    Raises
    ------
    InputError
        If nothing is named, or a number is out of range.
    """

    volume_ratio: float
    region: str | None = None
    points: str | None = None
    near: str | None = None
    within_mm: float = 20.0

    def __post_init__(self) -> None:
        check_volume_ratio(self.volume_ratio)
        if self.region is None and self.points is None and self.near is None:
            raise InputError(
                "growth needs region, points or near: the tissue that swells or "
                "contracts"
            )
        if not 0 < self.within_mm < np.inf:
            raise InputError(f"within_mm must be > 0 (got {self.within_mm})")

    def on(self, mesh: TetMesh) -> VolumeGrowth:
        """Return the load on a mesh; InputError if none of its cells is meant."""
        chosen = np.ones(mesh.n_cells, dtype=np.bool_)
        if self.region is not None:
            chosen &= mesh.region == _label(mesh, self.region)
        if self.points is not None:
            inside = np.zeros(mesh.n_points, dtype=np.bool_)
            inside[mesh.point_set(self.points)] = True
            chosen &= inside[mesh.cells].all(axis=1)
        if self.near is not None:
            there = mesh.region == _label(mesh, self.near)
            near = cells_near(mesh, np.unique(mesh.cells[there]), self.within_mm)
            chosen &= near & ~there
        cells = np.flatnonzero(chosen)
        if not len(cells):
            raise InputError(f"no cell of the mesh is meant by {self}")
        return VolumeGrowth(cells, np.full(len(cells), self.volume_ratio))


def cells_near(mesh: TetMesh, points: IntArray, within_mm: float) -> BoolArray:
    """Return which cells have their centre near one of some points.

    Parameters
    ----------
    mesh : TetMesh
    points : integer array
        One or more.
    within_mm : float
        How near.

    Returns
    -------
    (n_cells,) array of bool
    """
    from scipy.spatial import cKDTree

    centres = mesh.points[mesh.cells].mean(axis=1)
    distance, _ = cKDTree(mesh.points[points]).query(
        centres, distance_upper_bound=within_mm
    )
    near: BoolArray = np.isfinite(distance)
    return near


def _label(mesh: TetMesh, name: str) -> int:
    label = region_label(name)
    if label is None or not (mesh.region == label).any():
        there = ", ".join(region_name(i) for i in np.unique(mesh.region).tolist())
        raise InputError(f"the mesh has no region '{name}' (it has: {there})")
    return label
