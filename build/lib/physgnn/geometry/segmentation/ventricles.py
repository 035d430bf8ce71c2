"""Which enclosed cells are ventricle: the third region of a mesh."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pyvista as pv

from physgnn.geometry.regions import TUMOUR, VENTRICLE
from physgnn.geometry.surface import Surface
from physgnn.geometry.tetmesh import TetMesh


def with_ventricles(mesh: TetMesh, ventricles: Sequence[Surface]) -> TetMesh:
    """Return the mesh with its cells inside these surfaces in region 2.

    Parameters
    ----------
    mesh : TetMesh
        Made with the surfaces among those that `tetrahedralize` keeps; what they
        enclose is then in region 1, like a tumour.
    ventricles : sequence of Surface
        Closed, apart.
    """
    enclosed = np.flatnonzero(mesh.region == TUMOUR)
    centres = pv.PolyData(mesh.points[mesh.cells[enclosed]].mean(axis=1))
    region = mesh.region.copy()
    for surface in ventricles:
        closed = pv.PolyData.from_regular_faces(
            surface.points, surface.faces.astype(int)
        )
        inside = centres.select_interior_points(closed)["selected_points"]
        region[enclosed[np.asarray(inside, dtype=bool)]] = VENTRICLE
    return replace(mesh, region=region)
