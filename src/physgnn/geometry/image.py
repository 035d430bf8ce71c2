"""Images as arrays with a place in the world, and label maps among them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError

# Rounding in a NIfTI header's float32 affine stays far below this cosine.
SHEAR = 1e-3
INT32 = np.iinfo(np.int32)
# Of the voxels that are not 0: a label map that was resampled linearly has fractions at
# borders alone.
MOST_FRACTIONS = 0.5
# Labels of a map whose largest is wrong by a slip; grey values are more.
MOST_BEYOND = 200


def voxel_sizes(affine: FloatArray) -> FloatArray:
    """Return the voxel size along each index, in the unit of an affine, shape (3,).

    Raises
    ------
    InputError
        If the affine has a number that is not finite, or a size is 0.
    """
    if not np.isfinite(affine).all():
        raise InputError("an affine must be finite (this has NaN or infinity)")
    sizes: FloatArray = np.linalg.norm(affine[:3, :3], axis=0)
    if not (sizes > 0).all():
        raise InputError(f"voxels must have a size in mm (got {sizes})")
    return sizes


@dataclass(frozen=True, eq=False)
class ImageGrid:
    """Voxel centres in the world.

    Parameters
    ----------
    shape : (nx, ny, nz)
        Number of voxels along each index.
    affine : (4, 4) array
        From voxel index to world, mm, RAS+, as nibabel has it. Any orientation, any
        voxel size, but right angles between the voxel axes.

    Raises
    ------
    InputError
        If the shape is not three whole numbers ≥ 2, or the affine is not finite, is
        singular or sheared.
    """

    shape: tuple[int, int, int]
    affine: FloatArray

    def __post_init__(self) -> None:
        affine = np.array(self.affine, dtype=np.float64)
        object.__setattr__(self, "affine", affine)
        if len(self.shape) != 3 or min(self.shape) < 2:
            raise InputError(
                "an image needs three axes of two voxels or more "
                f"(got shape {tuple(self.shape)})"
            )
        object.__setattr__(self, "shape", tuple(int(n) for n in self.shape))
        if affine.shape != (4, 4):
            raise InputError(
                f"an affine must be a 4 by 4 matrix (got shape {affine.shape})"
            )
        sizes = voxel_sizes(affine)
        directions = affine[:3, :3] / sizes
        shear = np.abs(directions.T @ directions - np.eye(3)).max()
        if shear > SHEAR:
            raise InputError(
                f"the voxel axes must be at right angles (cosine {shear:.2g}): "
                "resample the image first"
            )

    @cached_property
    def voxel_mm(self) -> FloatArray:
        """Voxel size along each index, mm, shape (3,)."""
        return voxel_sizes(self.affine)

    @property
    def voxel_volume_mm3(self) -> float:
        """Volume of a voxel, mm³."""
        return float(self.voxel_mm.prod())

    def to_world(self, index: ArrayLike) -> FloatArray:
        """Return world coordinates, mm, of voxel indices (n, 3), fractions allowed."""
        points: FloatArray = np.asarray(index) @ self.affine[:3, :3].T
        return points + self.affine[:3, 3]

    def to_index(self, points: ArrayLike) -> FloatArray:
        """Return voxel indices, with fractions, of world coordinates (n, 3), mm."""
        inverse = np.linalg.inv(self.affine)
        index: FloatArray = np.asarray(points) @ inverse[:3, :3].T
        return index + inverse[:3, 3]


@dataclass(frozen=True, eq=False)
class Image:
    """One number a voxel.

    Parameters
    ----------
    data : (nx, ny, nz) array
        Values.
    affine : (4, 4) array
        See `ImageGrid`.

    Raises
    ------
    InputError
        If the data have not three axes or the affine cannot serve.
    """

    data: NDArray[np.generic]
    affine: FloatArray

    def __post_init__(self) -> None:
        grid = ImageGrid(self.data.shape, self.affine)
        object.__setattr__(self, "affine", grid.affine)

    @cached_property
    def grid(self) -> ImageGrid:
        """Where the voxels are."""
        return ImageGrid(self.data.shape, self.affine)


@dataclass(frozen=True, eq=False)
class LabelVolume(Image):
    """A segmentation: one whole number a voxel, 0 for background.

    Parameters
    ----------
    data : (nx, ny, nz) array
        Labels.
    affine : (4, 4) array
        See `ImageGrid`.
    names : mapping of label to str
        What the file calls them, if it does, as a segmentation of 3D Slicer.

    Raises
    ------
    InputError
        If the data are not whole numbers, or all are 0.
    """

    data: NDArray[np.int32]
    names: Mapping[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        whole = _labels(np.asarray(self.data))
        if not whole.any():
            raise InputError("the segmentation is empty: every voxel is 0")
        object.__setattr__(self, "data", whole)

    def mask(self, labels: tuple[int, ...]) -> BoolArray:
        """Return where any of these labels is."""
        return np.isin(self.data, labels)


def _labels(given: NDArray[Any]) -> NDArray[np.int32]:
    """Return voxels as labels; InputError if they are none."""
    fractions = given != np.round(given) if given.dtype.kind == "f" else np.zeros(1)
    n_fractions = int(np.count_nonzero(fractions))
    low, high = given.min(), given.max()
    beyond = bool(low < INT32.min or high > INT32.max)
    if n_fractions > MOST_FRACTIONS * np.count_nonzero(given) or (
        beyond and len(np.unique(given)) > MOST_BEYOND
    ):
        raise InputError(
            "a segmentation must hold whole numbers (this is an image, not a "
            "segmentation: see 'physgnn segment'): give the label map"
        )
    if n_fractions:
        raise InputError(
            f"a segmentation must hold whole numbers ({n_fractions} of its "
            f"{given.size} voxels do not, such as {given[fractions != 0][0]:.4g}, as "
            "after resampling): resample it with nearest neighbours"
        )
    if beyond:
        wrong = low if low < INT32.min else high
        raise InputError(
            f"labels must be in {INT32.min}…{INT32.max} (got {wrong}): give it a "
            "smaller number"
        )
    return given.astype(np.int32)
