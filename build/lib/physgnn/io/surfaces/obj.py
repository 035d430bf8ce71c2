"""Wavefront OBJ: the lines that hold geometry.

An own reader, because VTK's keeps coordinates in single precision only and does not
check the indices.
"""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import whole_numbers
from physgnn.io.untrusted.text import read_text


def read_obj(path: Path) -> Surface:
    """Read an OBJ surface; polygons become triangles, equal points one."""
    points: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    lines = read_text(path, names_in_latin1=True).splitlines()
    with reading(path, "OBJ"):
        for line in lines:
            match line.split():
                case ["v", x, y, z, *_]:
                    points.append([float(x), float(y), float(z)])
                case ["f", *corners]:
                    triangles += _fan([point_index(c, len(points)) for c in corners])
    if not points or not triangles:
        raise InputError(
            f"{path}: expected OBJ, but it has no 'v' and 'f' lines: rename it or "
            "export it again"
        )
    faces = whole_numbers(triangles, f"{path}: corners of faces")
    return merge_points(np.array(points), faces.astype(np.int32))


def point_index(corner: str, n_points: int) -> int:
    """Return the 0-based point of a corner such as 7, 7/1, 7//2 or −1 (the last)."""
    number = int(corner.split("/")[0])
    if number == 0:
        raise InputError(
            "points of a face count from 1, or back from -1 (got 0): export it again"
        )
    return number - 1 if number > 0 else n_points + number


def _fan(corners: list[int]) -> Iterator[tuple[int, int, int]]:
    return ((corners[0], b, c) for b, c in pairwise(corners[1:]))
