"""NIfTI images and label maps, as nibabel places them in the world: RAS+, mm."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io.integrity.packed import write_packed
from physgnn.io.medical.images.nifti_header import declared_by_nifti, parsed_nifti
from physgnn.io.medical.images.nifti_place import place_of
from physgnn.io.medical.images.voxels import ReadOptions, Voxels, three_axes
from physgnn.io.untrusted.compressed import read_unpacked

if TYPE_CHECKING:
    import nibabel as nib

SUFFIXES = (".nii", ".nii.gz")
DESCRIPTION_BYTES = 80  # NIfTI-1's field descrip


def read_nifti(path: Path, options: ReadOptions) -> Voxels:
    """Read a NIfTI image, packed or not."""
    image = parsed_nifti(path, read_unpacked(path, declared_by_nifti))
    data = three_axes(np.asanyarray(image.dataobj))
    return Voxels(data, place_of(path, image, options.affine, options.log))


def write_nifti(path: Path, image: Image, note: str) -> None:
    """Write a NIfTI image, a note in its description."""
    import nibabel as nib

    save_nifti(path, nib.Nifti1Image(image.data, image.affine), note=note)


def save_nifti(path: str | Path, image: "nib.Nifti1Image", *, note: str = "") -> None:
    """Save a nibabel image in mm, whole or not at all.

    A note is added to its description, as far as 80 bytes hold it.
    """
    path = Path(path)
    if not path.name.lower().endswith(SUFFIXES):
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
    write_packed(path, image.to_bytes())
