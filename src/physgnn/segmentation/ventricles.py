"""Ventricles by their intensity: the thick, deep fluid of a brain."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.filters import threshold_multiotsu

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image

SMOOTHING_VOXELS = 0.5
# Depths below the brain's surface as fractions of the largest: where fluid may be
# ventricle, and where each piece must reach.
MAY, MUST = 0.28, 0.6
# A core is fluid that holds balls of this radius, mm. Sulci, fissures and cisterns are
# thinner. Walls and horns within GROWN voxels of a core belong to it.
CORE_MM, GROWN = 3.0, 2
SMALLEST_CORE_MM3 = 300.0
# Dark fluid has at most this fraction of the white matter's intensity above the
# background; bright fluid has at least the inverse.
DARK = 0.75
# What a person's ventricles have together.
PLAUSIBLE_ML = (5.0, 150.0)
FEWEST = 1000  # voxels, for a histogram
FACES = ndimage.generate_binary_structure(3, 1)


@dataclass(frozen=True, eq=False)
class Ventricles:
    """What was found.

    Attributes
    ----------
    mask : boolean array
        Empty if they cannot be told from the rest.
    reason : str
        Why, if it is empty.
    """

    mask: BoolArray
    reason: str = ""


def find_ventricles(
    image: Image, brain: BoolArray, *, but: BoolArray, fluid_is_bright: bool = False
) -> Ventricles:
    """Find the ventricles in an upright image of cubes.

    Otsu's method with three classes (fluid, grey, white) is applied to the deep part of
    the brain, where there is little else. Of the fluid, what is thick and deep is kept.

    Parameters
    ----------
    image : Image
        On upright cubes.
    brain : boolean array
        On its voxels.
    but : boolean array
        Where no ventricle is, such as the tumour.
    fluid_is_bright : bool
        As in T2; dark in T1 and FLAIR.
    """
    nothing = np.zeros_like(brain)
    depth = ndimage.distance_transform_edt(brain, sampling=image.grid.voxel_mm)
    values = ndimage.gaussian_filter(
        np.asarray(image.data, np.float32), SMOOTHING_VOXELS
    )
    deep = brain & (depth > MAY * depth.max())
    limit, reason = _fluid_limit(
        values[deep & ~but], float(values.min()), fluid_is_bright
    )
    if reason:
        return Ventricles(nothing, reason)
    fluid = values > limit if fluid_is_bright else values < limit
    mask = _thick(deep & fluid & ~but, depth, image.grid.voxel_mm)
    ml = float(mask.sum()) * image.grid.voxel_volume_mm3 / 1000.0
    low, high = PLAUSIBLE_ML
    if not low <= ml <= high:
        return Ventricles(
            nothing,
            f"the thick, deep fluid has {ml:.1f} ml, where ventricles have {low:g} to "
            f"{high:g} ml",
        )
    return Ventricles(mask)


def _fluid_limit(
    values: NDArray[np.float32], background: float, bright: bool
) -> tuple[float, str]:
    """Return where fluid ends, or why the intensities do not tell."""
    if len(values) < FEWEST:
        return 0.0, "the brain has too few voxels"
    low, high = np.percentile(values, (0.1, 99.5))
    kept = values[(values >= low) & (values <= high)]
    if low >= high:
        return 0.0, "all of the brain has one intensity"
    first, second = threshold_multiotsu(kept, classes=3)  # type: ignore[no-untyped-call]
    dark, brightest = kept[kept < first].mean(), kept[kept >= second].mean()
    if bright:
        rest = kept[kept < second].mean()
        share = float((rest - background) / max(brightest - background, 1e-12))
    else:
        share = float((dark - background) / max(brightest - background, 1e-12))
    if share > DARK:
        return 0.0, (
            f"fluid and brain are too alike (intensities {share:.2f} to 1; "
            f"{DARK:g} or less is needed)"
        )
    return float(second if bright else first), ""


def _thick(may: BoolArray, depth: FloatArray, voxel_mm: FloatArray) -> BoolArray:
    """Return the deep pieces of an opening by a ball, and what adjoins them."""
    seed = ndimage.distance_transform_edt(may, sampling=voxel_mm) > CORE_MM
    if not seed.any():
        return np.zeros_like(may)
    near = ndimage.distance_transform_edt(~seed, sampling=voxel_mm) <= CORE_MM
    pieces, n = ndimage.label(near & may, FACES)
    sizes = np.bincount(pieces.ravel(), minlength=n + 1) * voxel_mm.prod()
    reach = np.asarray(ndimage.maximum(depth, pieces, np.arange(n + 1)))
    chosen = (sizes >= SMALLEST_CORE_MM3) & (reach > MUST * depth.max())
    chosen[0] = False
    grown = ndimage.binary_dilation(chosen[pieces], FACES, GROWN, mask=may)
    return np.asarray(ndimage.binary_fill_holes(grown), dtype=bool)
