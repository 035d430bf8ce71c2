"""NIfTI images and label maps, as nibabel places them in the world: RAS+, mm."""

from pathlib import Path

import nibabel as nib
import numpy as np
from nibabel.filebasedimages import ImageFileError
from nibabel.spatialimages import HeaderDataError
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io.atomic import whole_file

SUFFIXES = (".nii", ".nii.gz")
DESCRIPTION_BYTES = 80  # NIfTI-1's field descrip


def read_image(path: str | Path) -> Image:
    """Read an image of one number a voxel.

    Raises
    ------
    InputError
        If the file is missing, no NIfTI, not of three axes, or damaged.
    """
    path = Path(path)
    data, affine = _read(path)
    try:
        return Image(data, affine)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def read_segmentation(path: str | Path) -> LabelVolume:
    """Read a label map.

    Raises
    ------
    InputError
        As `read_image`, and if a voxel is not a whole number or all are 0.
    """
    path = Path(path)
    data, affine = _read(path)
    try:
        return LabelVolume(data, affine)  # type: ignore[arg-type]
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def write_image(path: str | Path, image: Image, *, note: str = "") -> None:
    """Write an image; what is no whole number as float32, a note in the description.

    Raises
    ------
    InputError
        If the name ends in neither .nii nor .nii.gz, or the folder is missing.
    """
    data = np.asarray(image.data)
    if data.dtype.kind == "f":
        data = data.astype(np.float32)
    elif data.dtype.kind == "b":
        data = data.astype(np.uint8)
    elif data.dtype.itemsize == 8:
        data = data.astype(np.int32)  # viewers know no 64-bit images
    save_nifti(path, nib.Nifti1Image(data, image.affine), note=note)


def save_nifti(path: str | Path, image: nib.Nifti1Image, *, note: str = "") -> None:
    """Save a nibabel image in mm, whole or not at all.

    A note is added to its description, as far as 80 bytes hold it.
    """
    path = Path(path)
    if not path.name.endswith(SUFFIXES):
        raise InputError(
            f"{path}: an image is written as {' or '.join(SUFFIXES)} "
            f"(got '{path.name}')"
        )
    image.header.set_xyzt_units("mm")
    if note:
        described = image.header["descrip"].item().decode()
        words = "; ".join(text for text in (described, note) if text)
        image.header["descrip"] = words.encode()[:DESCRIPTION_BYTES]
    # set both forms: some readers know the one, some the other
    image.set_qform(image.affine, 1)
    image.set_sform(image.affine, 1)
    with whole_file(path) as part:
        nib.save(image, part)


def _read(path: Path) -> tuple[NDArray[np.generic], FloatArray]:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if not path.name.endswith(SUFFIXES):
        raise InputError(
            f"{path}: expected a NIfTI image, {' or '.join(SUFFIXES)} "
            "(convert DICOM with dcm2niix)"
        )
    try:
        image = nib.load(path)
        data = np.asanyarray(image.dataobj)  # type: ignore[attr-defined]
    except (OSError, EOFError, ValueError, ImageFileError, HeaderDataError) as error:
        reason = " ".join(str(error).split())[:120]
        raise InputError(
            f"{path}: cannot be read as NIfTI ({reason}): export it again"
        ) from error
    while data.ndim > 3 and data.shape[-1] == 1:
        data = data[..., 0]
    affine = image.affine  # type: ignore[attr-defined]
    if affine is None or not np.isfinite(data).all():
        raise InputError(f"{path}: the image has NaN or infinite voxels: replace them")
    return data, np.asarray(affine, dtype=np.float64)
