"""FreeSurfer's images, .mgh and .mgz.

Source of the format: https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat.
"""

import math
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.image import Image
from physgnn.io.integrity.packed import write_packed
from physgnn.io.medical.images.voxels import ReadOptions, Voxels, affine_in_mm
from physgnn.io.untrusted.compressed import read_unpacked
from physgnn.io.untrusted.limits import check_size

HEADER_BYTES, VERSION = 284, 1
N_BYTES = {0: 1, 1: 4, 3: 4, 4: 2, 10: 2}
"""The type in the header, and how many bytes a voxel has."""
KINDS = {"f": np.float32, "i": np.int32, "u": np.int32}


def read_mgh(path: Path, options: ReadOptions) -> Voxels:
    """Read an image of FreeSurfer, packed or not."""
    import nibabel as nib

    content = read_unpacked(path, _declared)
    declared = _declared(content)
    check_size(path, declared, "the image")
    if declared > len(content) - HEADER_BYTES:
        raise InputError(
            f"its header declares {declared} bytes of voxels (it has "
            f"{len(content) - HEADER_BYTES}): it is cut off or damaged, so it cannot "
            "be read; export it again"
        )
    image = nib.MGHImage.from_bytes(content)
    if int(image.header["goodRASFlag"]) <= 0:
        options.log(
            f"{path}: its header does not say where the image lies: taken for coronal, "
            "with its middle at the origin, as FreeSurfer does"
        )
    data = np.asanyarray(image.dataobj)
    affine = affine_in_mm(path, image.affine, data.shape, unit="mm", log=options.log)
    return Voxels(data, affine)


def _declared(start: bytes) -> int:
    """Return how many bytes of voxels the first bytes of a file declare."""
    words = [int(n) for n in np.frombuffer(start[:28], ">i4")]
    if len(words) < 7 or words[0] != VERSION or words[5] not in N_BYTES:
        raise InputError(
            "expected an image of FreeSurfer, but it cannot be read (it has no header "
            "of one): convert it"
        )
    if min(words[1:5]) < 1:
        raise InputError(
            f"its header declares {words[1:5]} voxels: it is damaged, so it "
            "cannot be read; export it again"
        )
    return N_BYTES[words[5]] * math.prod(words[1:5])


def write_mgh(path: Path, image: Image, note: str) -> None:
    """Write an image of FreeSurfer, which has no place for a note."""
    import nibabel as nib

    del note
    data = np.asarray(image.data)
    if data.dtype != np.uint8:
        data = data.astype(KINDS[data.dtype.kind])
    write_packed(path, nib.MGHImage(data, image.affine).to_bytes())
