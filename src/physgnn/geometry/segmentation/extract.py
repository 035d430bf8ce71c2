"""Label map to closed, even, nested surfaces in world coordinates."""

from dataclasses import dataclass

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.label_tables import LABEL_TABLES, LabelTable
from physgnn.geometry.segmentation.mask_surface import LevelSet, even_surface, level_set
from physgnn.geometry.segmentation.masks import Mask, TissueMasks, tissue_masks
from physgnn.geometry.segmentation.volume_fit import SurfaceFit, surface_fit
from physgnn.geometry.surface import Surface

# Edges along the radius of the smallest piece: a tumour of 11 mm gets edges of 3.7 mm.
EDGES_PER_RADIUS = 3.0
# Tissue kept between two surfaces, in voxels and in edges of the brain's: the even
# triangles may cut so far into folds.
GAP_VOXELS, GAP_EDGES = 1.0, 0.25


@dataclass(frozen=True, eq=False)
class Segmentation:
    """The surfaces of a label map.

    Attributes
    ----------
    brain : Surface
        Closed, outward, RAS+ mm.
    tumours, ventricles : tuple of Surface
        Inside the brain and apart.
    fits : mapping of str to SurfaceFit
        How well each follows its labels.
    notes : tuple of str
        What was repaired in the labels.
    """

    brain: Surface
    tumours: tuple[Surface, ...]
    ventricles: tuple[Surface, ...]
    fits: dict[str, SurfaceFit]
    notes: tuple[str, ...]


def extract_surfaces(
    labels: LabelVolume,
    table: LabelTable = LABEL_TABLES["mask"],
    *,
    target_points: int = 10_000,
    smoothing_mm: float | None = None,
    closing_mm: float | None = None,
) -> Segmentation:
    """Turn a label map into surfaces to mesh.

    Parameters
    ----------
    labels : LabelVolume
        The segmentation.
    table : LabelTable
        What its labels mean.
    target_points : int
        Points of the tetrahedral mesh that the surfaces shall suit, 1000–200,000.
    smoothing_mm : float, optional
        Standard deviation of the smoothing, ≥ 0; by default the largest voxel size.
    closing_mm : float, optional
        Radius of the closing that fills sulci, ≥ 0; by default the table's.

    Raises
    ------
    InputError
        If an option is out of range or the labels hold no brain of one piece.
    """
    if not 1_000 <= target_points <= 200_000:
        raise InputError(f"target_points must be in 1000…200000 (got {target_points})")
    for name, value in (("smoothing_mm", smoothing_mm), ("closing_mm", closing_mm)):
        if value is not None and not 0.0 <= value <= 30.0:
            raise InputError(f"{name} must be in 0…30 (got {value})")
    masks = tissue_masks(labels, table, closing_mm=closing_mm)
    voxel = float(masks.grid.voxel_mm.max())
    smoothing = voxel if smoothing_mm is None else smoothing_mm
    edge = edge_for(int(masks.brain.sum()) * masks.grid.voxel_volume_mm3, target_points)
    return _Nest(masks, smoothing, edge).surfaces()


def edge_for(volume_mm3: float, target_points: int) -> float:
    """Return the edge of even tetrahedra, mm, that fill a volume with so many points.

    A lattice of edge h has a point for every h³/√2.
    """
    return float((np.sqrt(2.0) * volume_mm3 / target_points) ** (1 / 3))


class _Nest:
    """Level sets of a case, each kept apart from those before it."""

    def __init__(self, masks: TissueMasks, smoothing: float, edge: float) -> None:
        self._masks, self._smoothing, self._edge = masks, smoothing, edge
        self._gap = max(GAP_VOXELS * masks.grid.voxel_mm.max(), GAP_EDGES * edge)
        self._brain = level_set(masks.brain, masks.grid, smoothing)
        self._outside_of: list[LevelSet] = []
        self._fits: dict[str, SurfaceFit] = {}
        self._notes = list(masks.notes)

    def surfaces(self) -> Segmentation:
        """Mesh every tissue; those before take precedence."""
        masks = self._masks
        brain = even_surface(self._brain, masks.grid, self._edge)
        self._fits["brain"] = surface_fit(brain, masks.brain, masks.grid)
        tumours = [
            self._inner(mask, f"tumour {i + 1}") for i, mask in enumerate(masks.tumours)
        ]
        ventricles = [
            self._inner(mask, f"ventricle {i + 1}")
            for i, mask in enumerate(masks.ventricles)
        ]
        return Segmentation(
            brain, tuple(tumours), tuple(ventricles), self._fits, tuple(self._notes)
        )

    def _inner(self, mask: Mask, name: str) -> Surface:
        grid = self._masks.grid
        distance = level_set(mask, grid, self._smoothing)
        size = int((distance < 0).sum())
        distance = np.maximum(distance, self._brain + self._gap)
        for other in self._outside_of:
            distance = np.maximum(distance, self._gap - other)
        kept = int((distance < 0).sum())
        if kept < size:
            self._notes.append(
                f"{name}: {(size - kept) * grid.voxel_volume_mm3 / 1000:.2f} ml given "
                f"to the brain, to keep {self._gap:.1f} mm to the next surface"
            )
        self._outside_of.append(distance)
        radius = np.cbrt(0.75 / np.pi * kept * grid.voxel_volume_mm3)
        edge = min(self._edge, radius / EDGES_PER_RADIUS)
        surface = even_surface(distance, grid, edge)
        self._fits[name] = surface_fit(surface, mask, grid)
        return surface
