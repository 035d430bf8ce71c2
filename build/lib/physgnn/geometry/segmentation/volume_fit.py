"""How well a surface fits the labels it came from, in two numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field

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
    dice : float
        Of the voxels whose centres the surface encloses, with the mask.
    structures : mapping of str to float
        Dice of each structure that the mask is made of, where it is of several.
    """

    volume_mm3: float
    label_volume_mm3: float
    distance_mm: float
    voxel_mm: float
    dice: float
    structures: Mapping[str, float] = field(default_factory=dict)

    @property
    def volume_error(self) -> float:
        """Relative difference of the volumes."""
        return self.volume_mm3 / self.label_volume_mm3 - 1.0

    @property
    def worst_dice(self) -> float:
        """The smallest Dice, of the whole and of every structure."""
        return min([self.dice, *self.structures.values()])

    def __str__(self) -> str:
        each = ", ".join(f"{name} {d:.3f}" for name, d in self.structures.items())
        return (
            f"{self.volume_mm3 / 1000:.2f} ml, labels "
            f"{self.label_volume_mm3 / 1000:.2f} ml ({self.volume_error:+.2%}); "
            f"surfaces {self.distance_mm:.2f} mm apart "
            f"on average (voxels up to {self.voxel_mm:.2g} mm); "
            f"Dice with the map {self.dice:.3f}" + (f" ({each})" if each else "")
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
        dice=dice(enclosed_voxels(surface, grid), mask),
    )


def dice(one: BoolArray, other: BoolArray) -> float:
    """Return 2 |A ∩ B| / (|A| + |B|) of two masks (Dice, Ecology 26, 1945)."""
    both = int((one & other).sum())
    return 2.0 * both / max(int(one.sum()) + int(other.sum()), 1)


def enclosed_voxels(surface: Surface, grid: ImageGrid) -> BoolArray:
    """Return which voxels of a grid have their centre inside a closed surface."""
    index = grid.to_index(surface.points)
    low = np.clip(np.floor(index.min(axis=0)).astype(int) - 1, 0, None)
    high = np.minimum(np.ceil(index.max(axis=0)).astype(int) + 2, grid.shape)
    inside = np.zeros(grid.shape, dtype=bool)
    if (high - low < 2).any():
        return inside
    box = pv.ImageData(dimensions=tuple(high - low))
    poly = pv.PolyData.from_regular_faces(index - low, surface.faces.astype(int))
    found = poly.voxelize_binary_mask(reference_volume=box)
    values = np.asarray(found["mask"]).reshape(tuple(high - low), order="F") > 0
    inside[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = values
    return inside


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
