"""NIfTI images and label maps, as nibabel places them in the world: RAS+, mm."""

from pathlib import Path

import nibabel as nib
import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io.integrity.atomic import whole_file
from physgnn.io.medical.nifti_header import parsed_nifti
from physgnn.io.medical.nifti_place import place_of
from physgnn.io.untrusted.compressed import read_unpacked
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log

SUFFIXES = (".nii", ".nii.gz")
DESCRIPTION_BYTES = 80  # NIfTI-1's field descrip
WHAT = "a NIfTI image"


def read_image(
    path: str | Path, *, affine: str | None = None, log: Log = no_log
) -> Image:
    """Read an image of one number a voxel.

    Parameters
    ----------
    path : path
        The image.
    affine : str, optional
        "sform" or "qform": which of two places that disagree is meant.
    log : callable
        Called with what the header leaves open and how it was read.

    Raises
    ------
    InputError
        If the file is missing, no NIfTI, not of three axes, damaged, in colours or
        complex numbers, or says of two places that it lies there.
    """
    with reading(path, WHAT):
        return Image(*_read(Path(path), affine, log))


def read_segmentation(
    path: str | Path, *, affine: str | None = None, log: Log = no_log
) -> LabelVolume:
    """Read a label map.

    Parameters
    ----------
    path, affine, log
        As of `read_image`.

    Raises
    ------
    InputError
        As `read_image`, and if a voxel is not a whole number or all are 0.
    """
    with reading(path, WHAT):
        data, place = _read(Path(path), affine, log)
        return LabelVolume(data, place)  # type: ignore[arg-type]


def read_voxels(
    path: str | Path, *, affine: str | None = None, log: Log = no_log
) -> tuple[NDArray[np.generic], FloatArray]:
    """Read an image to be looked at, whose axes need not be at right angles.

    Parameters
    ----------
    path, affine, log
        As of `read_image`.

    Returns
    -------
    voxels : array
        With the axes that the file has, but for last ones of length 1.
    affine : (4, 4) array
        From voxel index to world, mm, RAS+.

    Raises
    ------
    InputError
        If the file is missing, no NIfTI, damaged, or says of two places that it lies
        there.
    """
    with reading(path, WHAT):
        return _read(Path(path), affine, log)


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


def _read(
    path: Path, affine: str | None, log: Log
) -> tuple[NDArray[np.generic], FloatArray]:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if not path.name.endswith(SUFFIXES):
        raise InputError(
            f"{path}: expected a NIfTI image, {' or '.join(SUFFIXES)} "
            "(convert DICOM with dcm2niix)"
        )
    image = parsed_nifti(path, read_unpacked(path))
    place = place_of(path, image, affine, log)
    data = np.asanyarray(image.dataobj)
    while data.ndim > 3 and data.shape[-1] == 1:
        data = data[..., 0]
    if not np.isfinite(data).all():
        raise InputError(f"{path}: the image has NaN or infinite voxels: replace them")
    return _native(data), place


def _native(data: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return voxels in this machine's byte order and of a width that ITK knows."""
    if data.dtype.kind == "f" and data.dtype.itemsize not in (4, 8):
        return data.astype(np.float64)
    return data.astype(data.dtype.newbyteorder("="), copy=False)
