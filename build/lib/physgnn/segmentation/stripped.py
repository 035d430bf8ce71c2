"""Whether a scan shows the brain alone, its skull taken off."""

import numpy as np
from scipy import ndimage

from physgnn.arrays import BoolArray
from physgnn.geometry.image import Image
from physgnn.geometry.plausibility import USUAL_ML

# The background of a stripped scan has one value, over so much of it.
BACKGROUND = 0.4
FACES = ndimage.generate_binary_structure(3, 1)


def foreground(image: Image) -> BoolArray | None:
    """Return what a background of one value leaves, if it may be a brain alone.

    None if the background is not of one value, or what it leaves has no brain's size:
    a head is larger.

    Parameters
    ----------
    image : Image
        The scan as it is: resampling blurs the edge.
    """
    data = np.asarray(image.data)
    corners = data[:: data.shape[0] - 1, :: data.shape[1] - 1, :: data.shape[2] - 1]
    values, counts = np.unique(corners, return_counts=True)
    background = values[counts.argmax()]
    if float((data == background).mean()) < BACKGROUND:
        return None
    mask = one_piece(data != background)
    ml = float(mask.sum()) * image.grid.voxel_volume_mm3 / 1000.0
    return mask if USUAL_ML[0] <= ml <= USUAL_ML[1] else None


def one_piece(mask: BoolArray) -> BoolArray:
    """Return the largest piece of a mask, its cavities filled."""
    pieces, n = ndimage.label(mask, FACES)
    if n == 0:
        return mask
    sizes = np.bincount(pieces.ravel())
    sizes[0] = 0
    filled = ndimage.binary_fill_holes(pieces == int(sizes.argmax()))
    return np.asarray(filled, dtype=bool)


def dice(one: BoolArray, other: BoolArray) -> float:
    """Return the overlap of two masks, 0 to 1."""
    return 2.0 * int((one & other).sum()) / max(int(one.sum()) + int(other.sum()), 1)
