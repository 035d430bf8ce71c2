"""From a tracker's or a scanner's space to the scan's: rigid transforms in files.

A text file holds a 4 × 4 matrix that takes measured points to the scan, RAS mm. A file
of ITK or 3D Slicer (.tfm, .h5) says where a point of the scan lies in the other space,
in LPS: ITK's transforms go that way, and 3D Slicer saves the one that takes measured
points to the scan so (`physgnn.imaging.transforms`). It is read inverted.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.child_processes import ending_with_us
from physgnn.errors import InputError
from physgnn.imaging.transforms import RAS_TO_LPS
from physgnn.io.medical.transform_parts import check_transform_text
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_text

TFM = ".tfm"  # text; .h5 holds the same as HDF5
ITK_SUFFIXES = (TFM, ".h5")
TEXT_SUFFIXES = (".txt", ".csv", ".mat")
LARGEST_BYTES = 1 << 20  # a linear transform is small; a field is not
TIMEOUT_S = 60.0
SEVERAL = "more than one transform"  # SimpleITK's warning as it takes the first
# Numbers are often rounded to four places; more than this is another unit, or shear.
RIGID_WITHIN = 0.01


def read_rigid_transform(path: str | Path) -> FloatArray:
    """Read the matrix that takes measured points to the scan.

    Parameters
    ----------
    path : path
        A 4 × 4 matrix as text (.txt, .csv), RAS mm, or a linear transform of ITK and
        3D Slicer (.tfm, .h5).

    Returns
    -------
    (4, 4) array
        RAS mm.

    Raises
    ------
    InputError
        If the file is not what its name says, or the transform is not rigid.
    """
    path = Path(path)
    with reading(path, "a rigid transform"):
        if path.suffix.lower() in ITK_SUFFIXES:
            found = np.linalg.inv(_in_ras(_from_itk(path)))
            return _checked(np.asarray(found, dtype=np.float64))
        if path.suffix.lower() in TEXT_SUFFIXES:
            return _checked(_from_text(path))
        raise InputError(
            f"a transform must be {', '.join((*TEXT_SUFFIXES[:2], *ITK_SUFFIXES))} "
            f"(got '{path.name}')"
        )


def transformed(matrix: FloatArray, points: FloatArray) -> FloatArray:
    """Return points (n, 3) where a 4 × 4 matrix takes them."""
    moved: FloatArray = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def _from_text(path: Path) -> FloatArray:
    text = read_text(path, names_in_latin1=True)
    lines = [line.split("#")[0] for line in text.splitlines()]
    words = " ".join(lines).replace(",", " ").replace(";", " ").split()
    if len(words) != 16:
        raise InputError(f"a 4 by 4 matrix has 16 numbers (got {len(words)})")
    matrix = np.array([float(word) for word in words]).reshape(4, 4)
    if not np.allclose(matrix[3], [0, 0, 0, 1]):
        raise InputError(
            f"the last row of the matrix must be 0 0 0 1 (got {matrix[3].tolist()}): "
            "write it a row a line"
        )
    return matrix


def _from_itk(path: Path) -> FloatArray:
    """Return the matrix of a linear ITK transform, LPS."""
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise InputError(
            f"a linear transform is below {LARGEST_BYTES >> 20} MB (got {size >> 20} "
            "MB): this looks like a displacement field"
        )
    if path.suffix.lower() == TFM:
        check_transform_text(read_text(path, names_in_latin1=True))
    command = [sys.executable, "-m", "physgnn.io.medical.transform_process", str(path)]
    try:
        ended = subprocess.run(
            ending_with_us(command),
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise InputError(f"reading it took more than {TIMEOUT_S:g} s") from error
    if ended.returncode != 0:
        raise InputError("ITK crashed on it: export it again")
    if SEVERAL in ended.stderr:
        raise InputError("the file must hold one transform: save the one that is meant")
    said = json.loads(ended.stdout)
    if "error" in said:
        raise InputError(str(said["error"]))
    places = np.array(said["places"])
    matrix = np.eye(4)
    matrix[:3, :3] = (places[1:] - places[0]).T
    matrix[:3, 3] = places[0]
    return matrix


def _in_ras(matrix: FloatArray) -> FloatArray:
    turn = np.eye(4)
    turn[:3, :3] = RAS_TO_LPS
    found: FloatArray = turn @ matrix @ turn
    return found


def _checked(matrix: FloatArray) -> FloatArray:
    if not np.isfinite(matrix).all():
        raise InputError("the numbers of the matrix must be finite")
    turn = matrix[:3, :3]
    scales = np.linalg.svd(turn, compute_uv=False)
    if np.abs(scales - 1.0).max() > RIGID_WITHIN:
        raise InputError(
            f"the transform must be rigid (it stretches by {scales.min():.3g} to "
            f"{scales.max():.3g}): check units (mm)"
        )
    if np.linalg.det(turn) < 0:
        raise InputError("the transform must be rigid (it mirrors): check its axes")
    return matrix
