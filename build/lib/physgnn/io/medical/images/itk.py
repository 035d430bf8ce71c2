"""Images that ITK alone reads, read by it in another process: Analyze, GIPL, MINC."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.errors import InputError
from physgnn.imaging.transforms import affine_from_itk
from physgnn.io.medical.images import itk_process
from physgnn.io.medical.images.voxels import (
    AXES,
    ReadOptions,
    Voxels,
    affine_in_mm,
    check_colours,
)
from physgnn.io.untrusted.isolated import Arrays, IsolatedReader
from physgnn.io.untrusted.limits import allowed_bytes

_READER = IsolatedReader(itk_process.__file__, "ITK")


def read_by_itk(path: Path, options: ReadOptions) -> Voxels:
    """Read an image by ITK."""
    arrays = _READER.read(path, what="image", limit=allowed_bytes(path))
    return itk_voxels(path, arrays, options)


def read_slices(path: Path, names: list[str], options: ReadOptions) -> Voxels:
    """Read an image of a folder's files, a slice each, in their order."""
    arrays = _READER.read(path, what="series", names=names, limit=allowed_bytes(path))
    return itk_voxels(path, arrays, options)


def series_of(path: Path) -> list[dict[str, Any]]:
    """Return the DICOM series of a folder: their UID, and the tags of their slices."""
    text = _READER.read(path, what="list")["text"]
    found: list[dict[str, Any]] = json.loads(text.tobytes())
    return found


def itk_voxels(path: Path, arrays: Arrays, options: ReadOptions) -> Voxels:
    """Return what ITK read, in RAS+."""
    n_axes = len(arrays["spacing"])
    check_colours(int(arrays["components"]))
    if n_axes < AXES:
        raise InputError(
            f"an image needs three axes (this has {n_axes}): give a volume"
        )
    affine = affine_from_itk(
        arrays["direction"][:AXES, :AXES],
        arrays["spacing"][:AXES],
        arrays["origin"][:AXES],
    )
    data = np.ascontiguousarray(arrays["data"]).T
    unit = "mm"
    return Voxels(
        data, affine_in_mm(path, affine, data.shape, unit=unit, log=options.log)
    )
