"""STL, ASCII and binary.

An own reader, because VTK keeps ASCII coordinates in single precision only, and
reads what it can of a damaged file.
"""

from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_bytes

HEADER_BYTES = 84
TRIANGLE = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
)


def read_stl(path: Path) -> Surface:
    """Read an STL surface; equal corners become one point.

    The normals in the file are ignored: the order of the corners says the same.
    """
    data = read_bytes(path)
    corners = binary_corners(data)
    if corners is None:
        corners = _ascii(data, path)
    faces = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    return merge_points(corners, faces)


def binary_corners(data: bytes) -> FloatArray | None:
    """Return the corners of a binary file; None if its size does not fit its count.

    The first word cannot tell the two kinds apart: binary files may begin with
    "solid" too.
    """
    if len(data) < HEADER_BYTES:
        return None
    count = int.from_bytes(data[80:HEADER_BYTES], "little")
    if len(data) != HEADER_BYTES + count * TRIANGLE.itemsize:
        return None
    triangles = np.frombuffer(data, TRIANGLE, count, HEADER_BYTES)
    return triangles["corners"].reshape(-1, 3).astype(np.float64)


def _ascii(data: bytes, path: Path) -> FloatArray:
    if not data.lstrip().startswith(b"solid") or b"\0" in data:
        raise InputError(
            f"{path}: expected an STL file, but it is neither ASCII (it does not begin "
            "with 'solid') nor binary (its size does not fit its number of faces): "
            "export it again"
        )
    # by lines: a pattern over all of them takes the square of the time
    lines = [line.split() for line in data.splitlines()]
    n_facets = sum(words[:1] == [b"facet"] for words in lines)
    found = [words[1:] for words in lines if words[:1] == [b"vertex"]]
    if len(found) != 3 * n_facets or b"endsolid" not in data:
        raise InputError(
            f"{path}: the ASCII STL file is cut off or damaged ({n_facets} facets, "
            f"{len(found)} vertices): export it again"
        )
    with reading(path, "three numbers a vertex"):
        return np.array(found).astype(np.float64).reshape(-1, 3)
