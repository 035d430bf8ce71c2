"""Displacements as other programs read them: ITK transforms, NIfTI fields.

To add a format, write a function and a row in ``FIELD_FORMATS``.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.imaging.transforms import (
    resampling_transform,
    to_itk_nifti,
    to_ras_nifti,
)
from physgnn.io.integrity.atomic import reserve, whole_file
from physgnn.io.medical.images.nifti import save_nifti
from physgnn.io.untrusted.native_output import silent_native_code

if TYPE_CHECKING:
    import SimpleITK as sitk

    from physgnn.imaging.field import DisplacementField

TRANSFORM_SUFFIX = ".h5"
BYTES_PER_VECTOR, HEADER_BYTES = 24, 1 << 14  # at most: float64, compressed


def write_field(
    path: str | Path,
    field: "DisplacementField",
    *,
    convention: str | None = None,
    note: str = "",
) -> None:
    """Write a displacement field.

    Parameters
    ----------
    path : path
        ``.h5`` for an ITK transform, else ``.nii`` or ``.nii.gz``.
    field : DisplacementField
        The inverse one for the conventions of ITK.
    convention : str, optional
        A row of ``FIELD_FORMATS``; by default ``"itk-transform"`` for .h5 and
        ``"itk"`` for NIfTI, which 3D Slicer and ANTs apply as they are.
    note : str
        What the displacement is called; goes into the description of a NIfTI file. An
        ITK transform has no place for it.

    Raises
    ------
    InputError
        If the name does not suit the convention, or the field is a forward one and the
        convention wants the inverse.
    """
    path = Path(path)
    is_transform = path.suffix.lower() == TRANSFORM_SUFFIX
    name = convention or ("itk-transform" if is_transform else "itk")
    if name not in FIELD_FORMATS:
        raise InputError(
            f"convention must be one of {', '.join(FIELD_FORMATS)} (got '{name}')"
        )
    if is_transform != (name == "itk-transform"):
        raise InputError(
            f"{path}: convention '{name}' is written as "
            f"{'.nii.gz' if is_transform else TRANSFORM_SUFFIX}"
        )
    FIELD_FORMATS[name](path, field, note)


def _write_transform(path: Path, field: "DisplacementField", note: str) -> None:
    del note
    transform = resampling_transform(field)
    save_transform(path, transform, n_vectors=math.prod(field.grid.shape))


def save_transform(path: Path, transform: "sitk.Transform", *, n_vectors: int) -> None:
    """Write a displacement field transform, whole or not at all.

    HDF5 prints every failed write, and crashes when the process ends: the disk is asked
    for the room beforehand.

    Raises
    ------
    InputError
        If it cannot be written whole.
    """
    import SimpleITK as sitk

    with whole_file(path, refused=(RuntimeError,)) as part:
        reserve(part, n_vectors * BYTES_PER_VECTOR + HEADER_BYTES)
        with silent_native_code():
            sitk.WriteTransform(transform, str(part))


def _write_itk_nifti(path: Path, field: "DisplacementField", note: str) -> None:
    save_nifti(path, to_itk_nifti(field), note=note)


def _write_ras_nifti(path: Path, field: "DisplacementField", note: str) -> None:
    save_nifti(path, to_ras_nifti(field), note=note)


FIELD_FORMATS: Mapping[str, Callable[[Path, "DisplacementField", str], None]] = {
    "itk-transform": _write_transform,
    "itk": _write_itk_nifti,
    "ras": _write_ras_nifti,
}
