"""Surfaces of any density to even ones that suit a number of points.

What the surfaces enclose is sampled as a label map would be, so that folds and thin
places come out as they do from one, and the volume is then set to the surfaces' own.
"""

from collections.abc import Sequence

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.segmentation.extract import edge_for
from physgnn.geometry.segmentation.mask_surface import with_volume
from physgnn.geometry.segmentation.masks import TissueMasks
from physgnn.geometry.segmentation.nest import Nest
from physgnn.geometry.segmentation.volume_fit import enclosed_voxels
from physgnn.geometry.surface import Surface, edge_lengths, volume
from physgnn.geometry.surfaces.checks import check_nested, check_surface
from physgnn.progress import Log, no_log

# Surfaces whose edges are this much shorter than the cells' are remeshed.
FINER = 0.8
SAMPLES_PER_EDGE = 5.0
MOST_SAMPLES = 30_000_000
MARGIN = 6  # samples around the brain
# Folds finer than the edges are smoothed over, so a brain's surface need not follow
# its mask as closely as a label map's, whose folds are closed beforehand.
FOLDED_DICE = 0.9
# Faces of an even surface for its area over edge squared, and points for its faces.
POINTS_PER_AREA = 1.0 / np.sqrt(0.75)
MOST_FACTOR = 1.5  # of the points asked for: fine pieces cost more than they are told


def too_fine(brain: Surface, target_points: int) -> bool:
    """Whether a brain's surface is finer than cells of so many points would be."""
    wanted = edge_for(abs(volume(brain)), target_points)
    return bool(edge_lengths(brain).mean() < FINER * wanted)


def remeshed(
    brain: Surface,
    tumours: Sequence[Surface],
    target_points: int,
    *,
    names: Sequence[str] = (),
    log: Log = no_log,
) -> tuple[Surface, list[Surface]]:
    """Return even surfaces of the same volumes, nested and apart.

    Parameters
    ----------
    brain, tumours : Surface
        As `check_surface` and `check_nested` let them pass.
    target_points : int
        Points of the tetrahedral mesh that the surfaces shall suit, 1000-200,000.
    names : sequence of str, optional
        What messages call the tumours.
    log : callable
        Told the size beforehand, and how the new surfaces fit the old ones.

    Raises
    ------
    InputError
        If `target_points` is out of range or nothing is left of a surface.
    """
    if not 1_000 <= target_points <= 200_000:
        raise InputError(f"target_points must be in 1000…200000 (got {target_points})")
    edge = edge_for(volume(brain), target_points)
    area = float(np.linalg.norm(area_vectors(brain.points, brain.faces), axis=1).sum())
    log(
        f"brain: a surface of {brain.n_points} points remeshed, edges of {edge:.1f} mm "
        f"and at most {int(POINTS_PER_AREA * area / edge**2) + 40} points, for a mesh "
        f"of about {target_points} and at most "
        f"{int(MOST_FACTOR * target_points)} points"
    )
    grid = _grid(brain, edge / SAMPLES_PER_EDGE)
    masks = TissueMasks(
        grid,
        enclosed_voxels(brain, grid),
        tuple(enclosed_voxels(tumour, grid) for tumour in tumours),
        ventricles=(),
        names=tuple(names) or tuple(f"tumour {i + 1}" for i in range(len(tumours))),
        structure=np.zeros(grid.shape, dtype=np.int32),
        structure_names=(),
        notes=(),
    )
    voxel = float(grid.voxel_mm[0])
    nest = Nest(masks, voxel, edge, brain_dice=FOLDED_DICE)
    new_brain, new_tumours, _, _ = nest.surfaces()
    for line in (*nest.notes, *(f"{name}: {fit}" for name, fit in nest.fits.items())):
        log(line)
    return _of_volumes([new_brain, *new_tumours], [brain, *tumours])


def _grid(brain: Surface, step: float) -> ImageGrid:
    """Return voxels around a surface, no more than `MOST_SAMPLES`."""
    low, high = brain.points.min(axis=0), brain.points.max(axis=0)
    step = max(step, float((np.prod(high - low) / MOST_SAMPLES) ** (1 / 3)))
    shape = np.ceil((high - low) / step).astype(int) + 2 * MARGIN
    affine = np.diag([step, step, step, 1.0])
    affine[:3, 3] = low - MARGIN * step
    return ImageGrid(tuple(shape.tolist()), affine)


def _of_volumes(
    made: Sequence[Surface], wanted: Sequence[Surface]
) -> tuple[Surface, list[Surface]]:
    """Set the volumes to those wanted, where the surfaces stay sound and apart."""
    try:
        sized = [
            check_surface(with_volume(new, volume(old)), "surface")[0]
            for new, old in zip(made, wanted, strict=True)
        ]
        check_nested(sized[0], sized[1:])
    except InputError:
        sized = list(made)
    return sized[0], sized[1:]
