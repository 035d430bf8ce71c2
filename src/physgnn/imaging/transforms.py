"""The one place where axes and directions change: RAS+ here, LPS in ITK's files.

See docs/reference/images.md. World points and vectors change by turning the
signs of x and y. ITK's transforms map a point of the resampled image to the point of
the input it shows: they are the inverse of the finite-element displacement.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image, ImageGrid

if TYPE_CHECKING:
    import nibabel as nib
    import SimpleITK as sitk

    from physgnn.imaging.field import DisplacementField

RAS_TO_LPS = np.diag([-1.0, -1.0, 1.0])
NIFTI_INTENT_VECTOR = 1007
TO_RAS = {"RAS": np.eye(3), "LPS": RAS_TO_LPS, "LAS": np.diag([-1.0, 1.0, 1.0])}
"""From the axes that headers of images name to RAS."""


def to_itk(image: Image) -> "sitk.Image":
    """Return an image as SimpleITK has it: the same place in the world, in LPS."""
    import SimpleITK as sitk

    return _placed(sitk.GetImageFromArray(np.asarray(image.data).T), image.grid)


def from_itk(image: "sitk.Image") -> Image:
    """Return a SimpleITK image in RAS+."""
    import SimpleITK as sitk

    affine = affine_from_itk(
        image.GetDirection(), image.GetSpacing(), image.GetOrigin()
    )
    return Image(sitk.GetArrayFromImage(image).T, affine)


def affine_from_itk(
    direction: ArrayLike, spacing: ArrayLike, origin: ArrayLike
) -> FloatArray:
    """Return the affine in RAS+ of what ITK says of an image's place, in LPS."""
    affine = np.eye(4)
    affine[:3, :3] = np.reshape(direction, (3, 3)) @ np.diag(np.asarray(spacing))
    affine[:3, 3] = origin
    return affine_in_ras(affine, "LPS")


def affine_in_ras(affine: FloatArray, system: str) -> FloatArray:
    """Return an affine to world axes "RAS", "LPS" or "LAS" as one to RAS+."""
    placed = affine.copy()
    placed[:3] = TO_RAS[system] @ affine[:3]
    return placed


def affine_in_lps(affine: FloatArray) -> FloatArray:
    """Return an affine to RAS+ as one to LPS."""
    return affine_in_ras(affine, "LPS")  # the same signs turn, there and back


def vectors_to_itk(field: "DisplacementField") -> "sitk.Image":
    """Return a field as a vector image, components in LPS."""
    import SimpleITK as sitk

    lps = np.ascontiguousarray(_to_lps(field.vectors).transpose(2, 1, 0, 3))
    return _placed(sitk.GetImageFromArray(lps, isVector=True), field.grid)


def resampling_transform(
    inverse: "DisplacementField",
) -> "sitk.DisplacementFieldTransform":
    """Return the transform that shows a rest image deformed.

    Raises
    ------
    InputError
        If the field is a forward one.
    """
    import SimpleITK as sitk

    require_inverse(inverse)
    return sitk.DisplacementFieldTransform(vectors_to_itk(inverse))


def to_itk_nifti(inverse: "DisplacementField") -> "nib.Nifti1Image":
    """Return ITK's and ANTs's displacement image: (nx, ny, nz, 1, 3), LPS, inverse.

    Raises
    ------
    InputError
        If the field is a forward one.
    """
    import nibabel as nib

    require_inverse(inverse)
    data = _to_lps(inverse.vectors)[..., None, :].astype(np.float32)
    image = nib.Nifti1Image(data, inverse.grid.affine)
    image.header.set_intent(NIFTI_INTENT_VECTOR)
    return image


def to_ras_nifti(field: "DisplacementField") -> "nib.Nifti1Image":
    """Return a field as (nx, ny, nz, 3), RAS+, in its own direction."""
    import nibabel as nib

    image = nib.Nifti1Image(field.vectors.astype(np.float32), field.grid.affine)
    image.header["descrip"] = f"{field.direction} displacement, mm, RAS".encode()
    return image


def require_inverse(field: "DisplacementField") -> None:
    """Raise InputError if a field is not the one that resampling needs."""
    if field.direction != "inverse":
        raise InputError("resampling needs the inverse field (got the forward one)")


def _placed(image: "sitk.Image", grid: ImageGrid) -> "sitk.Image":
    directions = RAS_TO_LPS @ grid.affine[:3, :3] / grid.voxel_mm
    image.SetOrigin((RAS_TO_LPS @ grid.affine[:3, 3]).tolist())
    image.SetSpacing(grid.voxel_mm.tolist())
    image.SetDirection(directions.ravel().tolist())
    return image


def _to_lps(vectors: FloatArray) -> FloatArray:
    lps: FloatArray = vectors * np.diag(RAS_TO_LPS)
    return lps


def points_to_ras(points: FloatArray, system: str) -> FloatArray:
    """Return points given in "RAS" or "LPS" in RAS+.

    Raises
    ------
    InputError
        If the system is another.
    """
    if system not in ("RAS", "LPS"):
        raise InputError(f"coordinates must be in RAS or LPS (got '{system}')")
    return points if system == "RAS" else _to_lps(points)
