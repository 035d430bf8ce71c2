"""Images and label maps of every format: one table, by the suffix.

To add a format, write a reader, and a writer if there can be one, and a row in
``IMAGE_FORMATS``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import Image, LabelVolume
from physgnn.io.medical.images.dicom import has_mark, read_dicom
from physgnn.io.medical.images.itk import read_by_itk
from physgnn.io.medical.images.metaimage import read_metaimage, write_metaimage
from physgnn.io.medical.images.mgh import read_mgh, write_mgh
from physgnn.io.medical.images.nifti import read_nifti, write_nifti
from physgnn.io.medical.images.nrrd import read_nrrd, write_nrrd
from physgnn.io.medical.images.segments import label_volume
from physgnn.io.medical.images.voxels import (
    AXES,
    ReadOptions,
    Voxels,
    finite_native,
    three_axes,
)
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log


@dataclass(frozen=True)
class ImageFormat:
    """How files of a suffix are read and written.

    Attributes
    ----------
    what : str
        What messages call one.
    read : callable
        From path and options to voxels.
    write : callable, optional
        Writes an image of numbers that viewers know, and a note.
    """

    what: str
    read: Callable[[Path, ReadOptions], Voxels]
    write: Callable[[Path, Image, str], None] | None = None


_NIFTI = ImageFormat("a NIfTI image", read_nifti, write_nifti)
_NRRD = ImageFormat("a NRRD image", read_nrrd, write_nrrd)
_META = ImageFormat("a MetaImage", read_metaimage, write_metaimage)
_MGH = ImageFormat("an image of FreeSurfer", read_mgh, write_mgh)
_DICOM = ImageFormat("a DICOM series", read_dicom)
_OTHER = ImageFormat("an image", read_by_itk)

IMAGE_FORMATS: Mapping[str, ImageFormat] = {
    ".nii.gz": _NIFTI,
    ".nii": _NIFTI,
    ".seg.nrrd": _NRRD,
    ".nrrd": _NRRD,
    ".nhdr": ImageFormat(_NRRD.what, read_nrrd),
    ".mha": _META,
    ".mhd": _META,
    ".mgz": _MGH,
    ".mgh": _MGH,
    ".dcm": _DICOM,
    ".ima": _DICOM,
    ".gipl": _OTHER,
    ".gipl.gz": _OTHER,
    ".hdr": _OTHER,
    ".img": _OTHER,
    ".img.gz": _OTHER,
    ".mnc": _OTHER,
}
"""By how a name ends; the first that fits. A folder is DICOM."""

WRITTEN = tuple(suffix for suffix, form in IMAGE_FORMATS.items() if form.write)
"""How names of images end that can be written."""

OF_LABELS = (".seg.nrrd",)
"""Those that hold nothing but labels."""


def read_image(
    path: str | Path,
    *,
    affine: str | None = None,
    series: str | None = None,
    log: Log = no_log,
) -> Image:
    """Read an image of one number a voxel.

    Parameters
    ----------
    path : path
        A file of a format in ``IMAGE_FORMATS``, or a folder of DICOM slices; of a
        folder with several series also ``folder/UID``.
    affine : str, optional
        "sform" or "qform": which of two places of a NIfTI image is meant.
    series : str, optional
        The UID of a DICOM series.
    log : callable
        Called with what the header leaves open and how it was read.

    Raises
    ------
    InputError
        If the file is missing, of an unknown format, damaged, not of three axes, in
        colours or complex numbers, or its place is in doubt.
    """
    path = Path(path)
    with reading(path, format_of(path).what):
        voxels = read_voxels(path, ReadOptions(affine, series, log))
        if voxels.segments and voxels.data.ndim > AXES:
            raise InputError(
                "this is a segmentation in layers, not an image: give the image"
            )
        return Image(voxels.data, voxels.affine)


def read_segmentation(
    path: str | Path,
    *,
    affine: str | None = None,
    series: str | None = None,
    log: Log = no_log,
) -> LabelVolume:
    """Read a label map, with the names of its labels where the file has them.

    Parameters
    ----------
    path, affine, series, log
        As of `read_image`.

    Raises
    ------
    InputError
        As `read_image`, and if a voxel is not a whole number or all are 0.
    """
    path = Path(path)
    with reading(path, format_of(path).what):
        return label_volume(
            path, read_voxels(path, ReadOptions(affine, series, log)), log
        )


def write_image(path: str | Path, image: Image, *, note: str = "") -> None:
    """Write an image; what is no whole number as float32.

    Parameters
    ----------
    path : path
        Its suffix is the format.
    image : Image
        Of a `LabelVolume`, .seg.nrrd keeps the names.
    note : str
        Goes into the header where the format has a place for it.

    Raises
    ------
    InputError
        If the format is unknown or cannot be written, or the folder is missing.
    """
    path = Path(path)
    suffix = suffix_of(path)
    write = IMAGE_FORMATS[suffix].write if suffix else None
    if write is None:
        raise InputError(
            f"{path}: an image is written as {' or '.join(WRITTEN)} (got '{path.name}')"
        )
    data = np.asarray(image.data)
    if data.dtype.kind == "f":
        data = data.astype(np.float32)
    elif data.dtype.kind == "b":
        data = data.astype(np.uint8)
    elif data.dtype.itemsize == 8:
        data = data.astype(np.int32)  # viewers know no 64-bit images
    write(path, replace(image, data=data), note)


def check_holds(path: str | Path, *, labels: bool) -> None:
    """Raise InputError if a file of this name holds labels, and these are none.

    Parameters
    ----------
    path : path
        Where an image is to go.
    labels : bool
        Whether it is a label map.

    Raises
    ------
    InputError
        If the name is that of a segmentation and the image is no label map.
    """
    if suffix_of(path) in OF_LABELS and not labels:
        raise InputError(f"{path}: a .seg.nrrd holds labels, no image: name a .nrrd")


def suffix_of(path: str | Path) -> str:
    """Return the suffix in the table that a name ends in, or nothing."""
    name = Path(path).name.lower()
    return next((suffix for suffix in IMAGE_FORMATS if name.endswith(suffix)), "")


def named_like(out: str | Path, image: str | Path, *, labels: bool = True) -> Path:
    """Return the name of a result: in the format of an image unless it says another.

    Parameters
    ----------
    out : path
        As the user gave it.
    image : path
        What the result is made of. The result of a DICOM series, and of others that
        cannot be written, is NIfTI.
    labels : bool
        Whether the result may be a label map; if not, that of a .seg.nrrd is .nrrd.

    Raises
    ------
    InputError
        If that is the image itself, or a name of label maps for what can be none.
    """
    named = Path(out)
    if not named.suffix:
        suffix = suffix_of(image)
        if suffix in OF_LABELS and not labels:
            suffix = ".nrrd"
        suffix = suffix if suffix in WRITTEN else ".nii.gz"
        named = named.with_name(named.name + suffix)
    if named.resolve() == Path(image).resolve():
        raise InputError(
            f"{named} would be written over the image it is made of: name another file"
        )
    check_holds(named, labels=labels)
    return named


def format_of(path: Path) -> ImageFormat:
    """Return the format of a file or folder.

    Raises
    ------
    InputError
        If it is not there, or of no known format.
    """
    if path.is_dir():
        return _DICOM
    suffix = suffix_of(path)
    if not path.exists():
        if path.parent.is_dir() and not suffix and _is_uid(path.name):
            return _DICOM
        raise InputError(f"{path}: no such file")
    if suffix:
        return IMAGE_FORMATS[suffix]
    if has_mark(path):  # their names often have no suffix
        return _DICOM
    raise InputError(
        f"{path}: expected an image, {', '.join(IMAGE_FORMATS)} or a folder of DICOM "
        f"(got '{path.name}')"
    )


def _is_uid(name: str) -> bool:
    return set(name) <= set("0123456789.") and name.count(".") > 1


def read_voxels(path: Path, options: ReadOptions) -> Voxels:
    """Return three axes of finite numbers, or four of a segmentation in layers.

    Unlike those of `read_image`, the voxel axes need not be at right angles.

    Raises
    ------
    InputError
        As `read_image`.
    """
    form = format_of(path)
    if options.series is not None and form is not _DICOM:
        raise InputError("only a folder of DICOM has series: leave --series out")
    if options.affine is not None and form is not _NIFTI:
        raise InputError(
            f"{path}: only NIfTI has an sform and a qform, and this is {form.what}: "
            "leave --affine out"
        )
    with reading(path, form.what):
        voxels = form.read(path, options)
        data = voxels.data
        if not (voxels.segments and data.ndim > AXES):
            data = three_axes(data)
        return Voxels(finite_native(data), voxels.affine, voxels.segments)
