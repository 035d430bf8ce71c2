"""Models in PLY, ASCII and binary: the coordinates of vertices, and their normals."""

from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.plans.normals import normals_at
from physgnn.io.plans.plan import Plan, shown
from physgnn.io.surfaces.formats import space_of
from physgnn.io.surfaces.ply import BYTE_ORDERS, Element, parse_header, read_polygons
from physgnn.io.untrusted.text import read_bytes

AXES, NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")


def read_ply_model(path: Path) -> Plan:
    """Read PLY; colours, faces and all else in it stay as they are.

    Raises
    ------
    InputError
        If its vertices do not come first, or have lists.
    """
    points, triangles = read_polygons(path)
    header, _, body = read_bytes(path).partition(b"end_header")
    end_of_line, _, body = body.partition(b"\n")
    head = header + b"end_header" + end_of_line + b"\n"
    kind, elements = parse_header(header.decode("latin-1"))
    vertices = elements[0]
    if vertices.name != "vertex" or any(c.length_code for c in vertices.columns):
        raise InputError("its vertices must come first, without lists: export it again")
    system = space_of(path)
    write = _text if kind == "ascii" else _binary

    def rewritten(moved: FloatArray) -> bytes:
        values = dict(zip(AXES, points_to_ras(moved, system).T, strict=True))
        if set(NORMALS) <= {column.name for column in vertices.columns}:
            normals = _normals(points_to_ras(moved, system), triangles)
            values |= dict(zip(NORMALS, normals.T, strict=True))
        return head + write(body, vertices, values, BYTE_ORDERS.get(kind, ""))

    return Plan(points_to_ras(points, system), rewritten, what="vertex")


def _normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    return normals_at(points, triangles, triangles, len(points))


def _binary(
    body: bytes, vertices: Element, values: dict[str, FloatArray], order: str
) -> bytes:
    row = np.dtype([(c.name, order + c.code) for c in vertices.columns])
    table = np.frombuffer(body, row, vertices.n_rows).copy()
    for name, column in values.items():
        table[name] = column
    return table.tobytes() + body[table.nbytes :]


def _text(
    body: bytes, vertices: Element, values: dict[str, FloatArray], order: str
) -> bytes:
    del order
    places = {column.name: i for i, column in enumerate(vertices.columns)}
    lines = body.split(b"\n")
    # a row a line, as the format has it; read by words it may be otherwise
    if any(len(line.split()) != len(places) for line in lines[: vertices.n_rows]):
        raise InputError("each vertex must have a line of its own: export it again")
    for i in range(vertices.n_rows):
        words = lines[i].split()
        for name, column in values.items():
            words[places[name]] = shown(column[i]).encode()
        lines[i] = b" ".join(words)
    return b"\n".join(lines)
