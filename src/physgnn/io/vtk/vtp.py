"""VTP: surfaces as VTK XML PolyData."""

from pathlib import Path

import numpy as np
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.vtk.reader import read_vtk

HEAD_BYTES = 4096


def read_vtp(path: Path) -> Surface:
    """Read a VTP surface; polygons become triangles, equal points one."""
    with path.open("rb") as file:
        if b'type="PolyData"' not in file.read(HEAD_BYTES):
            raise InputError(
                f"{path}: expected VTP, but it is no VTK XML PolyData: rename it or "
                "export it again"
            )
    data = read_vtk(path)
    corners = pv.convert_array(data.GetPolys().GetConnectivityArray())
    if data.n_points == 0 or len(corners) == 0:
        raise InputError(f"{path}: the surface is empty: export it again")
    # VTK does not look before it triangulates
    if corners.min() < 0 or corners.max() >= data.n_points:
        raise InputError(f"{path}: a face names a point that is not there")
    faces = data.triangulate().regular_faces
    return merge_points(np.asarray(data.points), faces.astype(np.int32))
