"""VTU and VTP files read without VTK, whose own readers crash on damaged ones.

Files of one piece, which is what this package, VTK, PyVista, meshio and 3D Slicer
write. Others go to `physgnn.io.vtk.isolated`.
"""

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.io.untrusted.text import read_bytes
from physgnn.io.untrusted.xml_tree import parsed
from physgnn.io.vtk.data import Array, VtkData
from physgnn.io.vtk.xml_arrays import (
    BYTE_ORDERS,
    COMPRESSORS,
    ArrayReader,
    OtherFeatureError,
)

APPENDED = re.compile(rb"<AppendedData\b[^>]*>")
END = b"</VTKFile>"
WORDS = {"UInt32": "u4", "UInt64": "u8"}
POLYGON, STRIP = 7, 6  # VTK's numbers of cell types
KINDS = {".vtu": "UnstructuredGrid", ".vtp": "PolyData"}


def read_vtk_xml(path: Path) -> VtkData:
    """Read an unstructured grid or polygons.

    Raises
    ------
    InputError
        If the file is damaged, or of another kind than its suffix says.
    OtherFeatureError
        If it is written in a way that this reader does not know.
    """
    root, reader = _opened(path)
    kind = KINDS[path.suffix.lower()]
    if root.tag != "VTKFile" or root.get("type") != kind:
        raise InputError(
            f"expected a VTK file of type {kind} (got {root.tag} {root.get('type')})"
        )
    grid = root.find(kind)
    pieces = [] if grid is None else grid.findall("Piece")
    if grid is None or not pieces:
        raise InputError("it holds no piece of a body: it is cut off or empty")
    if len(pieces) > 1:
        raise OtherFeatureError("several pieces")
    piece = pieces[0]
    connectivity, offsets, types = (
        _grid_cells(piece, reader) if kind == KINDS[".vtu"] else _faces(piece, reader)
    )
    n_points, n_cells = int(piece.get("NumberOfPoints", "")), len(types)
    points = _named(piece.find("Points"), reader)
    coordinates = next(iter(points.values()), np.empty((0, 3))).reshape(-1, 3)
    if len(coordinates) != n_points:
        raise InputError(
            f"it declares {n_points} points and holds {len(coordinates)}: it is damaged"
        )
    data = _named(piece.find("CellData"), reader)
    if kind == KINDS[".vtu"] and int(piece.get("NumberOfCells", "")) != n_cells:
        raise InputError("it does not hold as many cells as it declares")
    return VtkData(
        points=coordinates,
        connectivity=connectivity,
        offsets=offsets,
        cell_types=types,
        point_data=_named(piece.find("PointData"), reader),
        # of polygons, those of vertices and lines come first: nobody needs them
        cell_data=data if kind == KINDS[".vtu"] else {},
        field_data=_named(grid.find("FieldData"), reader),
    )


@dataclass(frozen=True, eq=False)
class VtkTree:
    """A VTK file as a tree, and what no XML parser takes.

    Attributes
    ----------
    root : Element
        Of the tree.
    tail : bytes
        From ``<AppendedData`` to the end of the file; empty if there are none.
    """

    root: ET.Element
    tail: bytes

    def as_bytes(self) -> bytes:
        """Return the file."""
        text: bytes = ET.tostring(self.root, encoding="utf-8", xml_declaration=True)
        return text.removesuffix(END) + self.tail if self.tail else text


def opened(path: Path) -> VtkTree:
    """Return the tree of a VTK file, without the appended data.

    Raises
    ------
    InputError
        If it cannot be parsed.
    """
    content = read_bytes(path)
    tag = APPENDED.search(content)
    if tag is None:
        return VtkTree(parsed(content), b"")
    return VtkTree(parsed(content[: tag.start()] + END), content[tag.start() :])


def _opened(path: Path) -> tuple[ET.Element, ArrayReader]:
    """Return the tree without the appended data, and what decodes the arrays."""
    tree = opened(path)
    root, tail = tree.root, tree.tail
    tag = APPENDED.match(tail)
    appended, in_base64 = b"", True
    if tag is not None:
        end = tail.rfind(b"</AppendedData>")
        start = tail.find(b"_", tag.end())
        if not tag.end() <= start < end:
            raise InputError("its appended data are cut off")
        appended, in_base64 = tail[start + 1 : end], b'"raw"' not in tag.group()
    order = BYTE_ORDERS.get(root.get("byte_order", "LittleEndian"))
    word = WORDS.get(root.get("header_type", "UInt32"))
    compressor = root.get("compressor")
    if order is None or word is None or compressor not in COMPRESSORS:
        raise OtherFeatureError(f"{compressor} {root.get('header_type')}")
    reader = ArrayReader(
        str(path), order, word, compressor is not None, appended, in_base64
    )
    return root, reader


def _named(parent: ET.Element | None, reader: ArrayReader) -> dict[str, Array]:
    """Return the arrays of an element by name."""
    if parent is None:
        return {}
    return {
        element.get("Name", ""): reader.read(element)
        for element in parent
        if element.tag in ("DataArray", "Array")
    }


def _grid_cells(piece: ET.Element, reader: ArrayReader) -> tuple[Array, Array, Array]:
    arrays = _named(piece.find("Cells"), reader)
    if "faces" in arrays and len(arrays["faces"]):
        raise OtherFeatureError("polyhedra")
    missing = [n for n in ("connectivity", "offsets", "types") if n not in arrays]
    if missing:
        raise InputError(f"its cells lack the array '{missing[0]}'")
    return arrays["connectivity"], _from_zero(arrays["offsets"]), arrays["types"]


def _faces(piece: ET.Element, reader: ArrayReader) -> tuple[Array, Array, Array]:
    """Return polygons and strips of triangles, in this order."""
    corners, ends, types = [np.empty(0, np.int64)], [np.empty(0, np.int64)], []
    for tag, kind in (("Polys", POLYGON), ("Strips", STRIP)):
        arrays = _named(piece.find(tag), reader)
        if "connectivity" in arrays and "offsets" in arrays:
            already = sum(map(len, corners))
            corners.append(arrays["connectivity"])
            ends.append(arrays["offsets"] + already)
            types += [kind] * len(arrays["offsets"])
    connectivity, offsets = np.concatenate(corners), np.concatenate(ends)
    return connectivity, _from_zero(offsets), np.array(types, np.int64)


def _from_zero(ends: Array) -> Array:
    return np.concatenate([np.zeros(1, ends.dtype), ends])
