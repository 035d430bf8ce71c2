"""Models in STL: corners of triangles, and the normal of each triangle."""

import re
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.normals import area_vectors
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.plans.plan import Plan, shown
from physgnn.io.surfaces.formats import space_of
from physgnn.io.surfaces.stl import HEADER_BYTES, TRIANGLE, binary_corners, read_stl
from physgnn.io.untrusted.text import read_bytes

NUMBERS = re.compile(rb"(\s*(?:facet\s+normal|vertex)\s)")


def read_stl_model(path: Path) -> Plan:
    """Read STL; its header and what programs keep beside each triangle stay."""
    read_stl(path)  # says what is wrong with it
    data, system = read_bytes(path), space_of(path)
    corners = binary_corners(data)
    if corners is None:
        return _ascii(data, system)
    triangles = np.frombuffer(data, TRIANGLE, len(corners) // 3, HEADER_BYTES).copy()

    def rewritten(moved: FloatArray) -> bytes:
        there = points_to_ras(moved, system)
        triangles["corners"] = there.reshape(-1, 3, 3)
        triangles["normal"] = _normals(there)
        return data[:HEADER_BYTES] + triangles.tobytes()

    return Plan(points_to_ras(corners, system), rewritten, what="vertex")


def _ascii(data: bytes, system: str) -> Plan:
    lines = data.splitlines(keepends=True)
    words = [line.split() for line in lines]
    vertices = [i for i, row in enumerate(words) if row[:1] == [b"vertex"]]
    facets = [i for i, row in enumerate(words) if row[:1] == [b"facet"]]
    corners = np.array([words[i][1:4] for i in vertices]).astype(np.float64)

    def rewritten(moved: FloatArray) -> bytes:
        there, kept = points_to_ras(moved, system), list(lines)
        for rows, values in ((vertices, there), (facets, _normals(there))):
            for i, row in zip(rows, values, strict=True):
                text = " ".join(map(shown, row)).encode()
                word = NUMBERS.match(lines[i])
                if word is None:
                    raise InputError(f"line {i + 1} must say 'facet normal'")
                end = lines[i][len(lines[i].rstrip(b"\r\n")) :]
                kept[i] = word[1] + text + end
        return b"".join(kept)

    return Plan(points_to_ras(corners, system), rewritten, what="vertex")


def _normals(corners: FloatArray) -> FloatArray:
    """Return the unit normals of triangles that follow each other."""
    vectors = area_vectors(
        corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    )
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: FloatArray = vectors / np.where(length > 0, length, 1.0)
    return unit
