"""A tumour grown from points inside of it."""

import numpy as np
import SimpleITK as sitk
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image

# Voxels join while they lie within so many standard deviations of the mean; the widest
# that stays within the bounds is taken.
WIDTHS = (3.0, 2.5, 2.0, 1.6, 1.3, 1.0)
ITERATIONS, FIRST_RADIUS = 3, 2
# Nothing farther than this from a point belongs to its tumour, mm; and not more than
# this volume, ml. A tumour that fills this much of the ball around it has no edge.
FARTHEST_MM = 40.0
SMALLEST_ML, LARGEST_ML = 0.1, 150.0
# A tumour is compact: its opening by a ball of this radius, mm, keeps most of it.
OPENING_MM, COMPACT = 2.0, 0.5
# Edges are blurred over this length, mm, which the growing stops short of.
BLUR_MM = 1.0
FACES = ndimage.generate_binary_structure(3, 1)
REMEDY = "paint it, and give the label map with --tumour labels.nii.gz"


def grow_tumour(
    image: Image, brain: BoolArray, seeds: FloatArray, *, but: BoolArray
) -> BoolArray:
    """Grow a tumour around each point in an upright image of cubes.

    Parameters
    ----------
    image : Image
        On upright cubes.
    brain : boolean array
        On its voxels.
    seeds : (n, 3) array
        Points inside of tumours, RAS+ mm.
    but : boolean array
        Where no tumour is.

    Raises
    ------
    InputError
        If there is no point, one lies outside of the brain, or nothing compact of 0.1
        to 150 ml grows from it.
    """
    if len(seeds) == 0:
        raise InputError("the tumour needs one point inside of it (got none)")
    blur = BLUR_MM / image.grid.voxel_mm
    smooth = ndimage.gaussian_filter(np.asarray(image.data, np.float32), blur)
    found = np.zeros_like(brain)
    for i, seed in enumerate(seeds):
        index = np.rint(image.grid.to_index(seed[None])[0]).astype(int)
        inside = bool((index >= 0).all() and (index < brain.shape).all())
        if not inside or not brain[tuple(index)]:
            raise InputError(
                f"point {i + 1} of the tumour must lie in the brain (it lies at "
                f"{np.round(seed, 1).tolist()}, RAS mm, outside of it): check that "
                "point and scan belong together"
            )
        found |= _grown(smooth, brain & ~but, index, image.grid.voxel_mm, i + 1)
    return found


def _grown(
    values: FloatArray, may: BoolArray, index: FloatArray, mm: FloatArray, number: int
) -> BoolArray:
    reach = np.ceil(FARTHEST_MM / mm).astype(int)
    low = np.maximum(index - reach, 0)
    window = tuple(slice(a, b + 1) for a, b in zip(low, index + reach, strict=True))
    seed = [int(i) for i in index - low]
    cut, inside = values[window], may[window]
    away = np.linalg.norm(
        (np.indices(cut.shape) - np.reshape(seed, (3, 1, 1, 1)))
        * mm.reshape(3, 1, 1, 1),
        axis=0,
    )
    inside = inside & (away <= FARTHEST_MM)
    # what is outside must never join: far from every value inside
    far = np.where(inside, cut, cut.max() + 10.0 * (np.ptp(cut) + 1.0))
    itk = sitk.GetImageFromArray(np.ascontiguousarray(far.T))
    for width in WIDTHS:
        joined = sitk.ConfidenceConnected(
            itk, [seed], ITERATIONS, width, FIRST_RADIUS, 1
        )
        piece = _compact(sitk.GetArrayFromImage(joined).T > 0, seed, mm)
        ml = float(piece.sum() * mm.prod()) / 1000.0
        at_edge = float((piece & (away > FARTHEST_MM - 2 * mm.max())).sum())
        if SMALLEST_ML <= ml <= LARGEST_ML and at_edge == 0.0:
            whole = np.zeros_like(may)
            edge = ndimage.distance_transform_edt(~piece, sampling=mm) <= BLUR_MM
            whole[window] = edge & inside
            return whole
    raise InputError(
        f"no tumour of {SMALLEST_ML:g} to {LARGEST_ML:g} ml with an edge grows from "
        f"point {number}: its intensities are those of its surroundings; {REMEDY}"
    )


def _compact(mask: BoolArray, seed: list[int], mm: FloatArray) -> BoolArray:
    """Return the piece nearest to the seed without strands and holes, or nothing."""
    core = ndimage.distance_transform_edt(mask, sampling=mm) > OPENING_MM
    if not core.any():
        return np.zeros_like(mask)
    opened = ndimage.distance_transform_edt(~core, sampling=mm) <= OPENING_MM
    pieces, _ = ndimage.label(opened & mask, FACES)
    places = np.argwhere(pieces > 0)
    nearest = places[np.linalg.norm((places - seed) * mm, axis=1).argmin()]
    piece = pieces == pieces[tuple(nearest)]
    if piece.sum() < COMPACT * mask.sum():
        return np.zeros_like(mask)
    return np.asarray(ndimage.binary_fill_holes(piece), dtype=bool)
