"""PLY, ASCII and binary.

An own reader, because VTK's faults on a file that is cut off and keeps coordinates in
single precision only. The format: Turk, The PLY polygon file format, 1994.
"""

import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.untrusted.numbers import whole_numbers
from physgnn.io.untrusted.text import read_bytes

# The names of number types, old and new, and their codes in Python's struct.
CODES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
    "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h",
    "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip
BYTE_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
FACE_LISTS = ("vertex_indices", "vertex_index")

# From a code and a count to so many numbers; each call reads on from the last.
Take = Callable[[str, int], tuple[Any, ...]]


class PlyColumn(NamedTuple):
    """A property: a number, or a list of numbers, in every row."""

    name: str
    code: str
    length_code: str | None  # of a list's length; None for a single number


class Element(NamedTuple):
    """A table of the file, such as its vertices."""

    name: str
    n_rows: int
    columns: list[PlyColumn]


def read_ply(path: Path) -> Surface:
    """Read a PLY surface; polygons become triangles, equal points one."""
    points, triangles = read_polygons(path)
    return merge_points(points, triangles.astype(np.int32))


def read_polygons(path: Path) -> tuple[FloatArray, IntArray]:
    """Return the vertices as they follow in the file, and polygons as triangles.

    Raises
    ------
    InputError
        If the file is cut off or damaged, or has no faces.
    """
    header, end, body = read_bytes(path).partition(b"end_header")
    if not header.startswith(b"ply") or not end:
        raise InputError(
            f"{path}: expected PLY, but it has no PLY header: rename it or export it "
            "again"
        )
    try:
        kind, elements = parse_header(header.decode("latin-1"))
        body = body.partition(b"\n")[2]
        check_rows(elements, len(body), is_text=kind == "ascii")
        take = _from_text(body) if kind == "ascii" else _from_bytes(body, kind)
        tables = {element.name: list(_rows(element, take)) for element in elements}
        points = [[row[axis] for axis in "xyz"] for row in tables["vertex"]]
        polygons = [_corners(row) for row in tables["face"]]
    except (ValueError, KeyError, IndexError, struct.error) as error:
        raise InputError(
            f"{path}: the PLY file is cut off or damaged ({error}): export it again"
        ) from error
    triangles = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
    if not points or not triangles:
        raise InputError(f"{path}: the surface is empty: export it again")
    corners = whole_numbers(triangles, f"{path}: corners of faces")
    return np.array(points, np.float64), corners


def parse_header(header: str) -> tuple[str, list[Element]]:
    """Return the kind of the body and the tables in it."""
    kind, elements = "", []
    for line in header.splitlines()[1:]:
        match line.split():
            case ["format", kind, _]:
                pass
            case ["element", name, count]:
                elements.append(Element(name, int(count), []))
            case ["property", "list", length, item, name]:
                column = PlyColumn(name, CODES[item], CODES[length])
                elements[-1].columns.append(column)
            case ["property", number, name]:
                elements[-1].columns.append(PlyColumn(name, CODES[number], None))
    return kind, elements


def check_rows(elements: list[Element], n_bytes: int, *, is_text: bool) -> None:
    """Raise ValueError if the body cannot hold the rows that the header declares."""
    least = 0
    for element in elements:
        codes = [column.length_code or column.code for column in element.columns]
        # in text, a digit and a space; the file's last number needs no space
        row = sum(2 if is_text else struct.calcsize(code) for code in codes)
        if element.n_rows < 0 or (element.n_rows > 0 and row == 0):
            raise ValueError(f"'{element.name}' has rows without properties")
        least += element.n_rows * row
    if least > n_bytes + 1:
        raise ValueError(f"it declares {least} bytes or more and holds {n_bytes}")


def _rows(element: Element, take: Take) -> Iterator[dict[str, Any]]:
    for _ in range(element.n_rows):
        row: dict[str, Any] = {}
        for name, code, length_code in element.columns:
            if length_code is None:
                row[name] = take(code, 1)[0]
            else:
                length = take(length_code, 1)[0]
                if length < 0:
                    raise ValueError(f"a list has {length} numbers")
                row[name] = take(code, length)
        yield row


def _corners(face: dict[str, Any]) -> tuple[int, ...]:
    name = next((name for name in FACE_LISTS if name in face), FACE_LISTS[0])
    corners: tuple[int, ...] = face[name]
    return corners


def _from_bytes(data: bytes, kind: str) -> Take:
    order, position = BYTE_ORDERS[kind], 0

    def take(code: str, count: int) -> tuple[Any, ...]:
        nonlocal position
        layout = f"{order}{count}{code}"
        numbers = struct.unpack_from(layout, data, position)
        position += struct.calcsize(layout)
        return numbers

    return take


def _from_text(data: bytes) -> Take:
    words, position = data.split(), 0

    def take(code: str, count: int) -> tuple[Any, ...]:
        nonlocal position
        chosen = words[position : position + count]
        if len(chosen) < count:
            raise ValueError("it ends early")
        position += count
        number = float if code in "fd" else int
        return tuple(number(word) for word in chosen)

    return take
