"""Whether what was taken for a brain has the size, the shape and the tissue of one.

A network that finds brains finds something in a ramp or a ball too. The bounds leave
room around what was measured: see docs/howto/segment.md.
"""

import numpy as np
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image

# Extents along each axis, mm: a newborn's brain and a large adult's have room.
SHORTEST_MM, LONGEST_MM = 75.0, 230.0
# Dice with the ellipsoid of the same moments; brains have 0.90 to 0.92.
ROUND = 0.8
# Of a mask's surface, what may lie on the faces of the image.
CUT = 0.25
# Folds of cortex: the spread, as a standard deviation, of what is finer than COARSE_MM
# and coarser than FINE_MM, in parts of the median intensity.
FINE_MM, COARSE_MM, CORE_MM, FOLDS = 2.0, 8.0, 6.0, 0.04
STEP_MM = 2.0
# In a CT shown in the window of the brain the skull has the window's highest value. It
# lies around the brain; MR shows bone dark, and fat farther out.
SKULL_MM, HIGHEST, SKULL_SHARE = (2.0, 9.0), 0.9, 0.3
REMEDY = "give a T1, T1c, T2 or FLAIR of a head, or pass --any-size (any_size=True)"


def check_brain(image: Image, brain: BoolArray) -> None:
    """Check that a mask in an upright image of cubes can be a brain.

    Parameters
    ----------
    image : Image
        On upright cubes.
    brain : boolean array
        What was taken for the brain, in one piece, on its voxels.

    Raises
    ------
    InputError
        If its extents, its roundness or its tissue are not a brain's, the image cuts
        it, or what lies around it is no skull of MR.
    """
    voxel = float(image.grid.voxel_mm[0])
    extents = np.array([np.ptp(i) + 1 for i in np.nonzero(brain)]) * voxel
    if extents.min() < SHORTEST_MM or extents.max() > LONGEST_MM:
        raise InputError(
            f"a brain must measure {SHORTEST_MM:g} to {LONGEST_MM:g} mm along each "
            f"axis (what was found measures {np.round(extents).tolist()} mm): {REMEDY}"
        )
    cut = _cut_share(brain)
    if cut > CUT:
        raise InputError(
            f"the scan must show the whole brain ({cut:.0%} of the surface found is on "
            f"the faces of the image): {REMEDY}"
        )
    every = max(1, round(STEP_MM / voxel))
    values = np.asarray(image.data, np.float32)
    coarse = (slice(None, None, every),) * 3
    fit = _roundness(brain[coarse])
    if fit < ROUND:
        raise InputError(
            f"a brain must be round (what was found overlaps with an ellipsoid by "
            f"{fit:.2f}, where {ROUND:g} is needed): {REMEDY}"
        )
    values = ndimage.uniform_filter(values, every)[coarse]
    folds = _folds(values, brain[coarse], every * voxel)
    if folds < FOLDS:
        raise InputError(
            "a brain must show grey and white matter (what was found varies by "
            f"{folds:.1%} over {FINE_MM:g} to {COARSE_MM:g} mm, where brains vary by "
            f"{FOLDS:.0%} or more; it looks like a phantom, a ramp or a CT): {REMEDY}"
        )
    bright = _bright_skull(values, brain[coarse], every * voxel)
    if bright > SKULL_SHARE:
        raise InputError(
            "the skull of an MR scan must be dark (around what was found, "
            f"{bright:.0%} has the scan's highest value; it looks like a CT in the "
            f"window of the brain): {REMEDY}"
        )


def _cut_share(brain: BoolArray) -> float:
    """Return how much of the surface lies on the faces of the image."""
    faces = sum(
        int(np.take(brain, at, axis).sum()) for axis in range(3) for at in (0, -1)
    )
    surface = int((brain & ~ndimage.binary_erosion(brain)).sum())
    return faces / max(surface, 1)


def _roundness(mask: BoolArray) -> float:
    """Return the Dice of a mask with the ellipsoid that has its moments."""
    places = np.argwhere(mask).astype(float)
    middle = places.mean(axis=0)
    # of a solid ellipsoid, the covariance is the squared half axes over 5
    inverse = np.linalg.inv(5.0 * np.cov((places - middle).T))
    volume = 4.0 / 3.0 * np.pi / np.sqrt(np.linalg.det(inverse))
    from_middle = places - middle
    shared = int(
        (np.einsum("ni,ij,nj->n", from_middle, inverse, from_middle) <= 1).sum()
    )
    return float(2.0 * shared / (volume + len(places)))


def _bright_skull(values: FloatArray, brain: BoolArray, voxel: float) -> float:
    """Return how much of what lies around a mask has the highest value there is."""
    away = ndimage.distance_transform_edt(~brain, sampling=voxel)
    around = values[(away > SKULL_MM[0]) & (away <= SKULL_MM[1])]
    low, high = float(values.min()), float(values.max())
    if not len(around) or high <= low:
        return 0.0
    return float((around >= low + HIGHEST * (high - low)).mean())


def _folds(values: FloatArray, brain: BoolArray, voxel: float) -> float:
    """Return how much intensities vary over the width of folds, inside of a mask."""
    core = ndimage.distance_transform_edt(brain, sampling=voxel) > CORE_MM
    if not core.any():
        return 0.0
    blurred = []
    for length in (FINE_MM, COARSE_MM):
        share = ndimage.gaussian_filter(brain.astype(np.float32), length / voxel)
        inside = ndimage.gaussian_filter(np.where(brain, values, 0.0), length / voxel)
        blurred.append(inside[core] / share[core])
    middle = float(np.median(values[core])) - min(float(values.min()), 0.0)
    # of a normal distribution, half of this range is the standard deviation; what a
    # mask takes in of the skull does not count
    low, high = np.percentile(blurred[0] - blurred[1], (16.0, 84.0))
    return float(high - low) / 2.0 / max(middle, 1e-12)
