"""Meshes and predictions as VTU, without loss.

Points in double precision; cell array ``region``; every point set twice: as field
data ``point_set:<name>`` (the indices in their order, what is read back) and as a
point array ``in_<name>`` of 0 and 1 to look at.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyvista as pv

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.atomic import whole_file
from physgnn.io.vtk.reader import read_vtk

SET_PREFIX = "point_set:"
# Without these words 3D Slicer takes the coordinates of a model for LPS.
SPACE, RAS = "SPACE", "RAS"


def write_mesh(path: str | Path, mesh: TetMesh) -> None:
    """Write a mesh with its regions and point sets; `read_mesh` gives it back exactly.

    Raises
    ------
    InputError
        If the name does not end in .vtu or the folder is missing.
    """
    save_grid(Path(path), grid_of(mesh))


def write_prediction(
    path: str | Path, mesh: TetMesh, fields: Mapping[str, FloatArray]
) -> None:
    """Write a mesh in its rest state with fields on its points.

    Parameters
    ----------
    path : path
        Ends in .vtu.
    mesh : TetMesh
        The mesh.
    fields : mapping of str to array
        Displacement, force, error: (n_points,) or (n_points, 3) each. A name says
        its unit, such as ``displacement_mm``.

    Raises
    ------
    InputError
        If a field has another shape, or the path cannot be written.
    """
    grid = grid_of(mesh)
    for name, field in fields.items():
        values = np.asarray(field)
        if values.shape not in ((mesh.n_points,), (mesh.n_points, 3)):
            raise InputError(
                f"field '{name}' must have one value or vector a point, "
                f"({mesh.n_points},) or ({mesh.n_points}, 3) (got {values.shape})"
            )
        grid.point_data[name] = values
    save_grid(Path(path), grid)


def read_mesh(path: str | Path) -> TetMesh:
    """Read a mesh with its regions and point sets.

    Raises
    ------
    InputError
        If the file is missing, is no VTU, has cells other than linear tetrahedra, or
        lacks the cell array ``region``.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; make a mesh with 'physgnn mesh'")
    with path.open("rb") as file:
        if path.suffix != ".vtu" or b'type="UnstructuredGrid"' not in file.read(4096):
            raise InputError(
                f"{path}: expected an unstructured grid, .vtu (got another file): make "
                "a mesh with 'physgnn mesh'"
            )
    grid = read_vtk(path)
    try:
        return mesh_of(grid)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def mesh_of(grid: pv.DataSet) -> TetMesh:
    """Return the mesh of a grid; InputError if it has other cells or no regions."""
    if grid.n_cells == 0 or (grid.celltypes != pv.CellType.TETRA).any():
        raise InputError("every cell must be a linear tetrahedron")
    if "region" not in grid.cell_data:
        have = ", ".join(grid.cell_data.keys()) or "none"
        raise InputError(
            f"needs a cell array 'region' (0 brain, 1 tumour; it has: {have})"
        )
    return TetMesh(
        points=grid.points,
        cells=grid.cell_connectivity.reshape(-1, 4),
        region=grid.cell_data["region"],
        point_sets={
            # a copy: VTK's 64-bit integers are not the type of NumPy's
            name.removeprefix(SET_PREFIX): np.array(grid.field_data[name], np.int64)
            for name in grid.field_data.keys()  # noqa: SIM118 (no mapping)
            if name.startswith(SET_PREFIX)
        },
    )


def grid_of(mesh: TetMesh) -> pv.UnstructuredGrid:
    """Return a mesh as VTK has it, with regions and point sets."""
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    grid.cell_data["region"] = mesh.region
    grid.field_data[SPACE] = [RAS]
    for name, ids in mesh.point_sets.items():
        inside = np.zeros(mesh.n_points, dtype=np.uint8)
        inside[ids] = 1
        grid.point_data[f"in_{name}"] = inside
        grid.field_data[SET_PREFIX + name] = ids
    return grid


def save_grid(path: Path, grid: pv.UnstructuredGrid) -> None:
    """Write a grid; InputError if the name does not end in .vtu."""
    if path.suffix != ".vtu":
        raise InputError(f"{path}: a mesh is written as .vtu (got '{path.suffix}')")
    with whole_file(path) as part:
        grid.save(part)
