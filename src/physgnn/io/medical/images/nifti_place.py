"""Where a NIfTI image lies, and in which unit its header says so.

A header has two places for the place, sform and qform, and a field for the unit.
Source: NIfTI-1 header, https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h.
Programs differ in which place they take, so two that disagree are refused.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.medical.images.voxels import affine_in_mm
from physgnn.progress import Log

if TYPE_CHECKING:
    import nibabel as nib

FORMS = ("sform", "qform")
# The three low bits of xyzt_units, and how many mm one is. 0 leaves it open.
UNIT_BITS = 7
UNITS_MM: Mapping[int, tuple[str, float]] = {
    0: ("", 1.0),
    1: ("metres", 1000.0),
    2: ("mm", 1.0),
    3: ("micrometres", 0.001),
}
# Below this, two places are one: headers hold single precision.
SAME_MM = 0.1


def place_of(
    path: Path, image: "nib.Nifti1Image", form: str | None, log: Log
) -> FloatArray:
    """Return the affine from voxel index to world, mm, RAS+.

    Parameters
    ----------
    path : path
        For messages.
    image : nibabel image
        With its header.
    form : str, optional
        "sform" or "qform", if the user has said which.
    log : callable
        Called with a line where the header left something open.

    Raises
    ------
    InputError
        If sform and qform lie more than a voxel apart and `form` does not say which is
        meant, the one asked for is not set, or the image is of no size in mm.
    """
    if form is not None and form not in FORMS:
        raise InputError(f"affine must be sform or qform (got '{form}')")
    places = _places(image)
    if form is not None and form not in places:
        raise InputError(
            f"the header sets no {form} (it sets {' and '.join(places) or 'neither'}): "
            "leave --affine out"
        )
    if len(places) == 2 and form is None:
        _check_agreement(path, image, places, log)
    chosen = form or next(iter(places), None)
    affine = image.affine if chosen is None else places[chosen]
    if chosen is None:
        log(
            f"{path}: neither sform nor qform is set, so the image's place is not "
            "known: its middle is put at the origin. Other programs may put its first "
            "voxel there"
        )
    elif form is not None and len(places) == 2:
        log(f"{path}: placed by its {form}, as asked for")
    return _in_mm(path, image, np.array(affine, dtype=np.float64), log)


def _places(image: "nib.Nifti1Image") -> dict[str, FloatArray]:
    """Return the places that the header sets, in the order of preference."""
    header = image.header
    found = {
        "sform": header.get_sform(coded=True),
        "qform": header.get_qform(coded=True),
    }
    return {name: affine for name, (affine, code) in found.items() if code > 0}


def _check_agreement(
    path: Path, image: "nib.Nifti1Image", places: Mapping[str, FloatArray], log: Log
) -> None:
    corners = np.indices((2, 2, 2)).reshape(3, -1).T * (np.array(image.shape[:3]) - 1)
    sform, qform = (corners @ a[:3, :3].T + a[:3, 3] for a in places.values())
    apart = float(np.linalg.norm(sform - qform, axis=1).max())
    voxel = float(np.linalg.norm(places["sform"][:3, :3], axis=0).max())
    if not apart <= voxel:
        raise InputError(
            f"sform and qform must agree within a voxel (a corner lies {apart:.1f} mm "
            "apart by the two): make both alike, or say which is meant with --affine "
            "sform or --affine qform (affine=…)"
        )
    if apart * UNITS_MM.get(_unit(image), ("", 1.0))[1] > SAME_MM:
        log(f"{path}: sform and qform differ by {apart:.2f}, less than a voxel: sform")


def _unit(image: "nib.Nifti1Image") -> int:
    return int(image.header["xyzt_units"]) & UNIT_BITS


def _in_mm(
    path: Path, image: "nib.Nifti1Image", affine: FloatArray, log: Log
) -> FloatArray:
    code = _unit(image)
    if code not in UNITS_MM:
        raise InputError(
            f"the unit of length in its header, {code}, is none of NIfTI's"
        )
    unit, _ = UNITS_MM[code]
    return affine_in_mm(path, affine, image.shape, unit=unit, log=log)
