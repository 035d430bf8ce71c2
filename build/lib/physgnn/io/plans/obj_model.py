"""Models in Wavefront OBJ: the lines of vertices, and of their normals."""

from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.plans.normals import normals_at
from physgnn.io.plans.plan import Plan, shown
from physgnn.io.surfaces.formats import space_of
from physgnn.io.surfaces.obj import point_index, read_obj
from physgnn.io.untrusted.text import read_text

Corners = list[tuple[int, int, int]]


def read_obj_model(path: Path) -> Plan:
    """Read OBJ; groups, materials, colours and texture stay as they are."""
    read_obj(path)  # says what is wrong with it
    lines = read_text(path, names_in_latin1=True).splitlines(keepends=True)
    words = [line.split() for line in lines]
    vertices = [i for i, row in enumerate(words) if row[:1] == ["v"]]
    normals = [i for i, row in enumerate(words) if row[:1] == ["vn"]]
    triangles, named = _corners(words, len(normals))
    points = np.array([words[i][1:4] for i in vertices]).astype(np.float64)
    system = space_of(path)

    def rewritten(moved: FloatArray) -> bytes:
        there, kept = points_to_ras(moved, system), list(lines)
        turned = normals_at(there, np.array(triangles), np.array(named), len(normals))
        for rows, values in ((vertices, there), (normals, turned)):
            for i, row in zip(rows, values, strict=True):
                end = lines[i][len(lines[i].rstrip("\r\n")) :]
                text = [words[i][0], *map(shown, row), *words[i][4:]]
                kept[i] = " ".join(text) + end
        return "".join(kept).encode()

    return Plan(points_to_ras(points, system), rewritten, what="vertex")


def _corners(words: list[list[str]], n_normals: int) -> tuple[Corners, Corners]:
    """Return the points of all triangles, and the normals that they name, or −1."""
    triangles, named = Corners(), Corners()
    n_points = seen = 0
    for row in words:
        n_points += row[:1] == ["v"]
        seen += row[:1] == ["vn"]
        if row[:1] != ["f"]:
            continue
        points = [point_index(corner, n_points) for corner in row[1:]]
        normals = [_normal(corner, seen, n_normals) for corner in row[1:]]
        for fan, of in ((triangles, points), (named, normals)):
            fan += [(of[0], of[i], of[i + 1]) for i in range(1, len(of) - 1)]
    return triangles, named


def _normal(corner: str, seen: int, n_normals: int) -> int:
    """Return the 0-based normal of a corner such as 7//2 or 7/1/2; −1 if none."""
    parts = corner.split("/")
    if len(parts) < 3 or not parts[2]:
        return -1
    found = point_index(parts[2], seen)
    if not 0 <= found < n_normals:
        raise InputError(f"a face names normal {parts[2]}, which is not there")
    return found
