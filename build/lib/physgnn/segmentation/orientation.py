"""Scans resampled to upright cubes, and what is found there back on the scan's voxels.

Networks for brains are trained on heads that stand upright. A scan may have thick
slices, any order and direction of axes, and be oblique. All of it ends here.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.image import Image, ImageGrid

CUBE_MM = 1.0
# A head of 300 mm fits at 1 mm; what is larger gets larger cubes.
MOST_CUBES = 300**3
# Slab of voxels that are mapped back at once, to bound the memory.
SLAB = 32


def upright_grid(grid: ImageGrid) -> ImageGrid:
    """Return cubes along right, anterior and superior that cover an image.

    The cubes are of 1 mm, larger if the image is larger than 300³ mm³.
    """
    ends = np.array(grid.shape) - 1
    corners = grid.to_world(np.indices((2, 2, 2)).reshape(3, -1).T * ends)
    low, high = corners.min(axis=0), corners.max(axis=0)
    cube = max(CUBE_MM, float(np.cbrt(np.prod(high - low) / MOST_CUBES)))
    affine = np.diag([cube, cube, cube, 1.0])
    affine[:3, 3] = low
    shape = tuple(int(n) for n in np.floor((high - low) / cube + 1e-6) + 1)
    return ImageGrid(shape, affine)  # type: ignore[arg-type]


def upright(image: Image) -> Image:
    """Return an image on its `upright_grid`, by linear interpolation, float32."""
    grid = upright_grid(image.grid)
    data = np.asarray(image.data, dtype=np.float32)
    return Image(_sampled(data, image.affine, grid), grid.affine)


def mask_on(grid: ImageGrid, mask: BoolArray, affine: FloatArray) -> BoolArray:
    """Return a mask of upright cubes on another grid: where it holds more than half.

    Parameters
    ----------
    grid : ImageGrid
        The voxels wanted.
    mask : boolean array
        On the cubes.
    affine : (4, 4) array
        Of the cubes.
    """
    share = _sampled(mask.astype(np.float32), affine, grid)
    return np.asarray(share > 0.5)


def _sampled(
    data: NDArray[np.float32], affine: FloatArray, grid: ImageGrid
) -> NDArray[np.float32]:
    """Return values at the voxels of a grid, 0 outside of the data."""
    to_index = np.linalg.inv(affine) @ grid.affine
    found = np.empty(grid.shape, np.float32)
    for start in range(0, grid.shape[0], SLAB):
        part = found[start : start + SLAB]
        ndimage.affine_transform(
            data,
            to_index[:3, :3],
            to_index[:3, 3] + to_index[:3, 0] * start,
            output_shape=part.shape,
            output=part,
            order=1,
            mode="grid-constant",
        )
    return found
