"""Models in VTP: the points of VTK XML PolyData, and their normals.

The file stays the tree that it is; two of its arrays are written anew, as text.
"""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.plans.normals import normals_at
from physgnn.io.plans.plan import Plan, shown
from physgnn.io.surfaces.formats import space_of
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtp import triangulated
from physgnn.io.vtk.xml_reader import opened

NORMALS = "Normals"


def read_vtp_model(path: Path) -> Plan:
    """Read VTP: surfaces, and tracts as lines; all arrays stay.

    Raises
    ------
    InputError
        If it is of several pieces.
    """
    data = read_vtk(path)
    tree = opened(path)
    pieces = tree.root.findall("PolyData/Piece")
    place = tree.root.find("PolyData/Piece/Points/DataArray")
    if len(pieces) != 1 or place is None:
        raise InputError("it must be polygons in one piece: save it again")
    system = space_of(path)
    normals = pieces[0].find(f"PointData/DataArray[@Name='{NORMALS}']")

    def rewritten(moved: FloatArray) -> bytes:
        there = points_to_ras(moved, system)
        _put(place, there)
        if normals is not None and len(data.connectivity):
            _put(normals, _normals(there, data))
        return tree.as_bytes()

    return Plan(points_to_ras(data.points, system), rewritten, what="vertex")


def _normals(points: FloatArray, data: VtkData) -> FloatArray:
    triangles = triangulated(data)
    return normals_at(points, triangles, triangles, len(points))


def _put(element: ET.Element, values: FloatArray) -> None:
    """Put numbers into an array as text, whatever it held in whatever form."""
    for child in list(element):
        element.remove(child)
    for name in ("offset", "RangeMin", "RangeMax", "type", "format"):
        element.attrib.pop(name, None)
    element.attrib |= {"type": "Float64", "format": "ascii", "NumberOfComponents": "3"}
    element.text = "\n".join(" ".join(map(shown, row)) for row in np.asarray(values))
