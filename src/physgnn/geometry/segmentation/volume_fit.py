"""How well a surface fits the labels it came from, in two numbers."""

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.surface import Surface, volume


@dataclass(frozen=True)
class SurfaceFit:
    """A surface against its mask.

    Attributes
    ----------
    volume_mm3, label_volume_mm3 : float
        Enclosed by the surface; of the mask's voxels.
    distance_mm : float
        Mean distance between the two boundaries, either way.
    voxel_mm : float
        The largest voxel size, to compare it with.
    """

    volume_mm3: float
    label_volume_mm3: float
    distance_mm: float
    voxel_mm: float

    @property
    def volume_error(self) -> float:
        """Relative difference of the volumes."""
        return self.volume_mm3 / self.label_volume_mm3 - 1.0

    def __str__(self) -> str:
        return (
            f"{self.volume_mm3 / 1000:.2f} ml, labels "
            f"{self.label_volume_mm3 / 1000:.2f} ml ({self.volume_error:+.2%}); "
            f"surfaces {self.distance_mm:.2f} mm apart "
            f"on average (voxels up to {self.voxel_mm:.2g} mm)"
        )


def surface_fit(surface: Surface, mask: BoolArray, grid: ImageGrid) -> SurfaceFit:
    """Compare a closed surface with the mask it shall follow.

    The mask's boundary is sampled at the centres of the voxel faces between inside and
    outside, the surface at the middles of its faces and at its points.
    """
    boundary = grid.to_world(_boundary(mask))
    poly = pv.PolyData.from_regular_faces(surface.points, surface.faces.astype(int))
    _, nearest = poly.find_closest_cell(boundary, return_closest_point=True)
    there = np.linalg.norm(boundary - nearest, axis=1).mean()
    middles = surface.points[surface.faces].mean(axis=1)
    samples = np.concatenate([surface.points, middles])
    back = cKDTree(boundary).query(samples)[0].mean()
    return SurfaceFit(
        volume_mm3=volume(surface),
        label_volume_mm3=int(mask.sum()) * grid.voxel_volume_mm3,
        distance_mm=float((there + back) / 2),
        voxel_mm=float(grid.voxel_mm.max()),
    )


def _boundary(mask: BoolArray) -> FloatArray:
    """Return the centres of the faces between inside and outside, in voxel indices."""
    centres = []
    for axis in range(3):
        first = np.take(mask, np.arange(mask.shape[axis] - 1), axis)
        second = np.take(mask, np.arange(1, mask.shape[axis]), axis)
        index = np.argwhere(first != second).astype(np.float64)
        index[:, axis] += 0.5
        centres.append(index)
    return np.concatenate(centres)
