"""Label map to closed, even, nested surfaces in world coordinates."""

from dataclasses import dataclass

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import LabelVolume
from physgnn.geometry.segmentation.labels.label_tables import LABEL_TABLES, LabelTable
from physgnn.geometry.segmentation.masks import SMALLEST_MM3, tissue_masks
from physgnn.geometry.segmentation.nest import Nest
from physgnn.geometry.segmentation.volume_fit import SurfaceFit
from physgnn.geometry.surface import Surface


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
        How well each follows its labels, by name: the brain, tumours, ventricles.
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
    smallest_mm3: float = SMALLEST_MM3,
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
    smallest_mm3 : float
        Tumours and ventricles below this are taken for brain, 0–10,000.

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
    if not 0.0 <= smallest_mm3 <= 10_000.0:
        raise InputError(f"smallest_mm3 must be in 0…10000 (got {smallest_mm3})")
    voxel = float(labels.grid.voxel_mm.max())
    smoothing = voxel if smoothing_mm is None else smoothing_mm
    masks = tissue_masks(
        labels,
        table,
        closing_mm=closing_mm,
        smallest_mm3=smallest_mm3,
        smoothing_mm=smoothing,
    )
    edge = edge_for(int(masks.brain.sum()) * masks.grid.voxel_volume_mm3, target_points)
    brain, tumours, ventricles, nest = Nest(masks, smoothing, edge).surfaces()
    return Segmentation(brain, tumours, ventricles, nest.fits, tuple(nest.notes))


def edge_for(volume_mm3: float, target_points: int) -> float:
    """Return the edge of even tetrahedra, mm, that fill a volume with so many points.

    A lattice of edge h has a point for every h³/√2.
    """
    return float((np.sqrt(2.0) * volume_mm3 / target_points) ** (1 / 3))
