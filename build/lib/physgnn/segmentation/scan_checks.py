"""Whether an image can be an MR scan of a head."""

import numpy as np
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.image import Image

# Voxels along each axis, and mm: less holds no brain.
FEWEST, SHORTEST_MM = 8, 80.0
# Air in CT has -1000 Hounsfield units. Half of the voxels below this is no MR.
AIR_BELOW = -300.0
# Neighbours in a label map are mostly alike, in a scan hardly ever.
ALIKE, FEW_VALUES = 0.8, 8


def check_scan(image: Image, *, any_size: bool = False) -> None:
    """Check that an image can be an MR scan of a head.

    Parameters
    ----------
    image : Image
        The image.
    any_size : bool
        Whether the user has said that the size is meant.

    Raises
    ------
    InputError
        If it is a label map, a CT, of one value, or too small for a head.
    """
    data = np.asarray(image.data)
    extent = image.grid.voxel_mm * data.shape
    if min(data.shape) < FEWEST or (extent.min() < SHORTEST_MM and not any_size):
        raise InputError(
            f"a scan of a head must have {FEWEST} voxels and {SHORTEST_MM:g} mm or "
            f"more along each axis (this has {tuple(data.shape)} voxels, "
            f"{np.round(extent, 1).tolist()} mm): give the whole scan"
        )
    if data.min() == data.max():
        raise InputError(
            f"a scan must have contrast (every voxel is {data.flat[0]}): it is empty; "
            "export it again"
        )
    if np.median(data) < AIR_BELOW or np.percentile(data, 5) < 2 * AIR_BELOW:
        raise InputError(
            "a scan must be MR (this looks like a CT: its background is below "
            f"{AIR_BELOW:g}): give a T1, T1c, T2 or FLAIR"
        )
    _check_no_labels(data)


def is_label_map(data: NDArray[np.generic]) -> bool:
    """Return whether values are those of a label map and not a scan's."""
    values, alike = _values_and_likeness(data)
    whole = bool((values == np.rint(values)).all())
    return len(values) <= FEW_VALUES or (whole and alike > ALIKE)


def _values_and_likeness(
    data: NDArray[np.generic],
) -> tuple[NDArray[np.generic], float]:
    """Return the values there are, and how many neighbours are alike."""
    some = data[tuple(slice(None, None, 2) for _ in range(3))]
    first, second = data[:-1], data[1:]
    both = (first != 0) & (second != 0)
    alike = float((first == second)[both].mean()) if both.any() else 1.0
    return np.unique(some), alike


def _check_no_labels(data: NDArray[np.generic]) -> None:
    if is_label_map(data):
        values, alike = _values_and_likeness(data)
        raise InputError(
            "a scan must have grey values (this looks like a label map: "
            f"{len(values)} values, {alike:.0%} of neighbouring voxels alike): mesh it "
            "with 'physgnn mesh', or give the scan"
        )
