"""VTP: surfaces as VTK XML PolyData."""

from pathlib import Path

import numpy as np

from physgnn.arrays import BoolArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.xml_reader import POLYGON, STRIP

HEAD_BYTES = 4096
SMALLEST = 3  # corners of a face


def read_vtp(path: Path) -> Surface:
    """Read a VTP surface; polygons become triangles, equal points one."""
    with path.open("rb") as file:
        if b'type="PolyData"' not in file.read(HEAD_BYTES):
            raise InputError(
                f"{path}: expected VTP, but it is no VTK XML PolyData: rename it or "
                "export it again"
            )
    data = read_vtk(path)
    if data.n_points == 0 or len(data.connectivity) == 0:
        raise InputError(f"{path}: the surface is empty: export it again")
    with reading(path, "a VTP surface"):
        return merge_points(data.points, triangulated(data).astype(np.int32))


def triangulated(data: VtkData) -> IntArray:
    """Return the triangles of polygons and strips, (n, 3).

    Raises
    ------
    InputError
        If a face has fewer than three corners.
    """
    import pyvista as pv

    if (np.diff(data.offsets) < SMALLEST).any():
        raise InputError(f"a face has fewer than {SMALLEST} corners")
    polygons = pv.PolyData(
        data.points,
        faces=_with_counts(data, data.cell_types == POLYGON),
        strips=_with_counts(data, data.cell_types == STRIP),
    )
    triangles: IntArray = polygons.triangulate().regular_faces.astype(np.int64)
    return triangles


def _with_counts(data: VtkData, chosen: BoolArray) -> IntArray | None:
    """Return cells as VTK takes them, each after the number of its corners."""
    if not chosen.any():
        return None
    lengths = np.diff(data.offsets)
    inside = np.repeat(chosen, lengths)
    # an entry more at the start of every cell
    places = np.concatenate([[0], np.cumsum(lengths[chosen])[:-1]])
    return np.insert(data.connectivity[inside], places, lengths[chosen])
