"""What an image file holds, and the checks that every format shares."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import voxel_sizes
from physgnn.geometry.plausibility import check_millimetres
from physgnn.io.untrusted.limits import check_size
from physgnn.progress import Log, no_log

UNITS_MM: Mapping[str, float] = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre"), 1.0),
    **dict.fromkeys(("cm", "centimeter", "centimeters"), 10.0),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1000.0),
    **dict.fromkeys(("um", "µm", "micron", "microns"), 0.001),
    **dict.fromkeys(("micrometer", "micrometers", "micrometre", "micrometres"), 0.001),
}  # fmt: skip
"""What headers call units of length, and how many mm one is."""
AXES = 3


@dataclass(frozen=True)
class ReadOptions:
    """What a user says beside the name of an image.

    Attributes
    ----------
    affine : str, optional
        "sform" or "qform", which only NIfTI has.
    series : str, optional
        The UID of a DICOM series.
    log : callable
        Called with what the file leaves open and how it was read.
    """

    affine: str | None = None
    series: str | None = None
    log: Log = no_log


@dataclass(frozen=True)
class Segment:
    """A segment of 3D Slicer: the voxels of one label in one layer.

    Attributes
    ----------
    name : str
        What its user called it.
    label : int
        The value of its voxels.
    layer : int
        The first index of voxels that have layers.
    """

    name: str
    label: int
    layer: int = 0


@dataclass(frozen=True, eq=False)
class Voxels:
    """Voxels with a place, before anybody says whether they are grey values or labels.

    Attributes
    ----------
    data : array
        (nx, ny, nz), or (n_layers, nx, ny, nz) where segments overlap.
    affine : (4, 4) array
        From voxel index to world, mm, RAS+.
    segments : tuple of Segment
        What 3D Slicer calls the labels.
    """

    data: NDArray[np.generic]
    affine: FloatArray
    segments: tuple[Segment, ...] = field(default=())


def voxels_of(
    path: Path, content: bytes, dtype: np.dtype[Any], shape: Sequence[int]
) -> NDArray[np.generic]:
    """Return the array that bytes hold, its first index running fastest.

    Raises
    ------
    InputError
        If the shape does not fit the bytes.
    """
    declared = declared_bytes(path, dtype, shape)
    if declared != len(content):
        raise InputError(
            f"its header declares {declared} bytes of voxels (it has {len(content)}): "
            "it is cut off or damaged, so it cannot be read; export it again"
        )
    return np.frombuffer(content, dtype).reshape(tuple(shape), order="F")


def declared_bytes(path: Path, dtype: np.dtype[Any], shape: Sequence[int]) -> int:
    """Return how many bytes voxels take; InputError if that is too many."""
    if min(shape, default=0) < 1:
        raise InputError(f"an image must have voxels (its header says {list(shape)})")
    declared = dtype.itemsize * math.prod(shape)  # integers, which do not overflow
    check_size(path, declared, "the image")
    return declared


def check_colours(n_numbers: int, what: str = "a colour") -> None:
    """Raise InputError if a voxel has more than one number."""
    if n_numbers != 1:
        raise InputError(
            f"an image must hold one real number a voxel (this is {what} image, "
            f"{n_numbers} numbers a voxel): convert it to grey values or labels"
        )


def three_axes(data: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return voxels without further axes of length one.

    Raises
    ------
    InputError
        If there are more axes, as in a series over time, or fewer.
    """
    while data.ndim > AXES and data.shape[-1] == 1:
        data = data[..., 0]
    if data.ndim == AXES:
        return data
    _check_volume(data.shape)
    several = " by ".join(str(n) for n in data.shape[AXES:] if n > 1)
    raise InputError(
        f"an image needs three axes (this has {data.ndim}, {data.shape}: a series of "
        f"{several} volumes): give one volume of it"
    )


def _check_volume(shape: Sequence[int]) -> None:
    if len(shape) < AXES:
        raise InputError(
            f"an image needs three axes (this has {len(shape)}, {tuple(shape)}): give "
            "the volume, not a slice"
        )


def finite_native(data: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return voxels in this machine's byte order and of a width that ITK knows.

    Raises
    ------
    InputError
        If they are no real numbers, or not finite.
    """
    if data.dtype.kind not in "buif":
        raise InputError(
            f"an image must hold one real number a voxel (this is a {data.dtype} "
            "image): convert it to grey values or labels"
        )
    if not np.isfinite(data).all():
        raise InputError("the image has NaN or infinite voxels: replace them")
    if data.dtype.kind == "f" and data.dtype.itemsize not in (4, 8):
        return data.astype(np.float64)
    return data.astype(data.dtype.newbyteorder("="), copy=False)


def affine_in_mm(
    path: Path, affine: FloatArray, shape: Sequence[int], *, unit: str, log: Log
) -> FloatArray:
    """Return an affine in mm, whose image can be in mm.

    Parameters
    ----------
    path : path
        For messages.
    affine : (4, 4) array
        In the unit of the file.
    shape : sequence of int
        Of the voxels.
    unit : str
        What the header calls its unit; empty if it does not say.
    log : callable
        Called if it was converted.

    Raises
    ------
    InputError
        If there are fewer than three axes, the unit is unknown, or the image has no
        size or place in mm.
    """
    _check_volume(shape)
    mm = UNITS_MM.get(unit.strip().lower(), 1.0 if not unit.strip() else 0.0)
    if mm == 0.0:
        raise InputError(
            f"lengths must be in mm (its header says '{unit}'): export it in mm"
        )
    placed = np.array(affine, dtype=np.float64)
    voxel_sizes(placed)
    placed[:3] *= mm
    far = placed[:3, :3] * (np.array(shape[:3]) - 1)
    box = np.stack([np.zeros(3), np.linalg.norm(far, axis=0)])
    check_millimetres(placed[:3, 3] + box, str(path))
    if mm != 1.0:
        log(f"{path}: its header is in {unit.strip()}: converted to mm")
    return placed
