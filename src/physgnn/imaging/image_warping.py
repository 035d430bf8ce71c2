"""The image as it would be after the deformation."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.imaging.field import DisplacementField
from physgnn.imaging.transforms import from_itk, resampling_transform, to_itk

INTERPOLATIONS: Mapping[str, str] = {
    "linear": "sitkLinear",
    "nearest": "sitkNearestNeighbor",
    "cubic": "sitkBSpline",
}


def warp(
    image: Image, inverse: DisplacementField, *, interpolation: str | None = None
) -> Image:
    """Return an image of the rest state deformed, on its own grid.

    Parameters
    ----------
    image : Image
        The rest state, such as the preoperative T1 or a label map.
    inverse : DisplacementField
        Of `inverse_field`; beyond its grid nothing moves.
    interpolation : str, optional
        "linear", "nearest" or "cubic"; by default nearest for a `LabelVolume`, else
        linear.

    Returns
    -------
    Image
        A LabelVolume if that is what came; otherwise float32 unless the nearest voxel
        was taken.

    Raises
    ------
    InputError
        If the interpolation is unknown or mixes the labels of a label map, or the field
        is a forward one.
    """
    import SimpleITK as sitk

    is_labels = isinstance(image, LabelVolume)
    name = interpolation or ("nearest" if is_labels else "linear")
    if name not in INTERPOLATIONS:
        raise InputError(
            f"interpolation must be one of {', '.join(INTERPOLATIONS)} (got '{name}')"
        )
    if is_labels and name != "nearest":
        raise InputError(
            f"a label map is warped with interpolation nearest (got '{name}', which "
            "mixes labels into others): leave the interpolation out"
        )
    if name != "nearest":
        image = Image(np.asarray(image.data, dtype=np.float32), image.affine)
    moving = to_itk(image)
    transform = resampling_transform(inverse)
    between = getattr(sitk, INTERPOLATIONS[name])
    moved = from_itk(sitk.Resample(moving, moving, transform, between, 0.0))
    return replace(image, data=moved.data)
