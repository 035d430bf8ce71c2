"""Ventricles: fluid by its intensity, where the template's ventricles are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.filters import threshold_multiotsu
from skimage.segmentation import watershed

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image
from physgnn.segmentation.template_prior import Prior, ventricle_prior

SMOOTHING_VOXELS = 0.5
# Distances from the template's ventricles, mm: where intensities are looked at, where
# fluid is ventricle for sure, and where it may be. Large ventricles reach that far.
LOOKED_AT, SURE, MAY = 10.0, 2.0, 15.0
# The template's other fluid is other fluid for sure where it is so far from ventricles.
APART = 6.0
# Pieces of less are noise.
SMALLEST_MM3 = 50.0
# Dark fluid has at most this fraction of the white matter's intensity above the
# background; bright fluid has at least the inverse.
DARK = 0.75
# What a person's ventricles have together.
PLAUSIBLE_ML = (5.0, 150.0)
FEWEST = 1000  # voxels, for a histogram
OTHER, VENTRICLE = 1, 2


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

    Otsu's method with three classes (fluid, grey, white) is applied around the
    template's ventricles, where there is little else. Watersheds of the fluid's width
    part the ventricles from fissures and cisterns that touch them.

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
    if brain.sum() < FEWEST:
        return Ventricles(nothing, "the brain has too few voxels")
    values = ndimage.gaussian_filter(
        np.asarray(image.data, np.float32), SMOOTHING_VOXELS
    )
    prior = ventricle_prior(image, brain & ~but)
    looked_at = brain & ~but & (prior.to_ventricles < LOOKED_AT)
    limit, reason = _fluid_limit(
        values[looked_at], float(values.min()), fluid_is_bright
    )
    if reason:
        return Ventricles(nothing, reason)
    fluid = values > limit if fluid_is_bright else values < limit
    mask = _parted(brain & fluid & ~but, prior, image.grid.voxel_mm)
    ml = float(mask.sum()) * image.grid.voxel_volume_mm3 / 1000.0
    low, high = PLAUSIBLE_ML
    if not low <= ml <= high:
        return Ventricles(
            nothing,
            f"the fluid there has {ml:.1f} ml, where ventricles have {low:g} to "
            f"{high:g} ml",
        )
    return Ventricles(mask)


def _fluid_limit(
    values: NDArray[np.float32], background: float, bright: bool
) -> tuple[float, str]:
    """Return where fluid ends, or why the intensities do not tell."""
    if len(values) < FEWEST:
        return 0.0, "nothing of the brain is where the template has ventricles"
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


def _parted(fluid: BoolArray, prior: Prior, voxel_mm: FloatArray) -> BoolArray:
    """Return the fluid whose watershed is a ventricle, in pieces that start there."""
    near, other = prior.to_ventricles, prior.to_other_fluid
    width = ndimage.distance_transform_edt(fluid, sampling=voxel_mm)
    markers = np.zeros(fluid.shape, np.int32)
    markers[fluid & (other < SURE) & (near > APART)] = OTHER
    markers[fluid & (near > MAY)] = OTHER
    markers[fluid & (near < SURE) & (other > near)] = VENTRICLE
    parts = watershed(-width, markers, mask=fluid)  # type: ignore[no-untyped-call]
    found = parts == VENTRICLE
    pieces, n = ndimage.label(found)
    sizes = np.bincount(pieces.ravel(), minlength=n + 1) * voxel_mm.prod()
    kept = sizes >= SMALLEST_MM3
    kept[0] = False
    return np.asarray(ndimage.binary_fill_holes(kept[pieces]), dtype=bool)
