"""A predicted displacement read back, and the deformed body written."""

from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.atomic import whole_file
from physgnn.io.vtk_reader import read_vtk
from physgnn.io.vtu import read_mesh

DISPLACEMENT = "displacement_mm"


def read_displacement(path: str | Path) -> tuple[TetMesh, NDArray[np.float64]]:
    """Read a mesh in its rest state and the displacement on its points, mm.

    Parameters
    ----------
    path : path
        VTU, as `physgnn predict` or `write_prediction` leaves it.

    Raises
    ------
    InputError
        If it is no mesh or has no point array ``displacement_mm``.
    """
    mesh = read_mesh(path)
    arrays = read_vtk(Path(path)).point_data
    if DISPLACEMENT not in arrays or arrays[DISPLACEMENT].shape != mesh.points.shape:
        have = ", ".join(arrays.keys()) or "none"
        raise InputError(
            f"{path}: needs a point array '{DISPLACEMENT}' of three components (it "
            f"has: {have}); make it with 'physgnn predict'"
        )
    return mesh, np.asarray(arrays[DISPLACEMENT], dtype=np.float64)


def write_deformed(
    path: str | Path, mesh: TetMesh, displacement: NDArray[np.float64]
) -> None:
    """Write the body where it moves to: .vtu the mesh, .vtp its outer surface.

    The point array ``displacement_mm`` leads back to the rest state. Unlike a rest
    state, what is written may have cells turned inside out.

    Raises
    ------
    InputError
        If the name has another suffix or the folder is missing.
    """
    path = Path(path)
    moved = mesh.points + displacement
    if path.suffix == ".vtu":
        body = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, moved)
        body.cell_data["region"] = mesh.region
    elif path.suffix == ".vtp":
        body = pv.PolyData.from_regular_faces(moved, boundary_faces(mesh).astype(int))
    else:
        raise InputError(
            f"{path}: a deformed body is written as .vtu or .vtp (got '{path.suffix}')"
        )
    body.point_data[DISPLACEMENT] = displacement
    if isinstance(body, pv.PolyData):
        body = body.clean(point_merging=False)
    with whole_file(path) as part:
        body.save(part)
