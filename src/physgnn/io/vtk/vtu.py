"""Meshes and predictions as VTU, without loss.

Points in double precision; cell array ``region``; every point set twice: as field
data ``point_set:<name>`` (the indices in their order, what is read back) and as a
point array ``in_<name>`` of 0 and 1 to look at.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.plausibility import check_millimetres, other_unit
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import whole_numbers
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.writer import write_vtk
from physgnn.progress import Log, no_log

if TYPE_CHECKING:
    import pyvista as pv

REMOVED_POINTS, REMOVED_CELLS = "removed_points", "removed_cells"  # field data
SET_PREFIX = "point_set:"
TETRA, CORNERS = 10, 4  # VTK's number of linear tetrahedra, and their corners
# Without these words 3D Slicer takes the coordinates of a model for LPS.
SPACE, RAS = "SPACE", "RAS"


def write_mesh(
    path: str | Path,
    mesh: TetMesh,
    *,
    notes: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Write a mesh with its regions and point sets; `read_mesh` gives it back exactly.

    Parameters
    ----------
    path : path
        Where it goes, .vtu.
    mesh : TetMesh
        The mesh; lengths in mm.
    notes : mapping of str to lines of text, optional
        Become field data, such as ``mesher``; `read_mesh` leaves them out.

    Raises
    ------
    InputError
        If the name does not end in .vtu or the folder is missing.
    """
    grid = grid_of(mesh)
    add_notes(grid, notes)
    save_grid(Path(path), grid)


def write_prediction(
    path: str | Path,
    mesh: TetMesh,
    fields: Mapping[str, FloatArray],
    *,
    notes: Mapping[str, Sequence[str]] | None = None,
    removed: TetMesh | None = None,
) -> None:
    """Write a mesh in its rest state with fields on its points.

    Parameters
    ----------
    path : path
        Ends in .vtu.
    mesh : TetMesh
        The mesh.
    fields : mapping of str to array
        Displacement, force, error: (n_points,) or (n_points, 3) each; a
        symmetric tensor (n_points, 6): xx, yy, zz, xy, yz, xz. A name says its unit,
        such as ``displacement_mm``.
    notes : mapping of str to lines of text, optional
        Become field data, such as ``status`` and ``reasons``.
    removed : TetMesh, optional
        Tissue that a resection took out, at rest: the mesh is what is left, and this
        stands in the field data, as points and cells of its own.

    Raises
    ------
    InputError
        If a field has another shape, or the path cannot be written.
    """
    grid = grid_of(mesh)
    for name, field in fields.items():
        values = np.asarray(field)
        n = mesh.n_points
        if values.shape not in ((n,), (n, 3), (n, 6)):
            raise InputError(
                f"field '{name}' must have one value or vector a point, or a symmetric "
                f"tensor, ({n},), ({n}, 3) or ({n}, 6) (got {values.shape})"
            )
        grid.point_data[name] = values
    add_notes(grid, notes)
    if removed is not None:
        grid.field_data[REMOVED_POINTS] = removed.points
        grid.field_data[REMOVED_CELLS] = removed.cells
    save_grid(Path(path), grid)


def add_notes(data: "pv.DataSet", notes: Mapping[str, Sequence[str]] | None) -> None:
    """Put lines of text into field data; a name without lines is left out.

    VTK takes ASCII alone: other characters, such as those of a user's labels, are
    written as escapes.
    """
    for name, lines in (notes or {}).items():
        if lines:
            data.field_data[name] = [
                line.encode("ascii", "backslashreplace").decode() for line in lines
            ]


def read_mesh(path: str | Path, *, log: Log = no_log) -> TetMesh:
    """Read a mesh with its regions and point sets.

    Parameters
    ----------
    path : path
        The file, .vtu; points in mm.
    log : callable
        Called with a line if it would be a brain in another unit.

    Returns
    -------
    TetMesh
        The mesh, bit for bit as `write_mesh` got it.

    Raises
    ------
    InputError
        If the file is missing, is no VTU, has cells other than linear tetrahedra, lacks
        the cell array ``region``, or cannot be in mm.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; make a mesh with 'physgnn mesh'")
    with path.open("rb") as file:
        head = file.read(4096)
        if path.suffix.lower() != ".vtu" or b'type="UnstructuredGrid"' not in head:
            raise InputError(
                f"{path}: expected an unstructured grid, .vtu (got another file): make "
                "a mesh with 'physgnn mesh'"
            )
    with reading(path, "a VTU mesh"):
        mesh = mesh_of(read_vtk(path))
    check_millimetres(mesh.points, str(path))
    for line in other_unit(float(mesh.cell_volumes.sum()), str(path)):
        log(line)
    return mesh


def mesh_of(grid: VtkData) -> TetMesh:
    """Return the mesh of a grid; InputError if it has other cells or no regions."""
    four = np.diff(grid.offsets) == CORNERS
    if grid.n_cells == 0 or not ((grid.cell_types == TETRA) & four).all():
        raise InputError("every cell must be a linear tetrahedron")
    if "region" not in grid.cell_data:
        have = ", ".join(grid.cell_data) or "none"
        raise InputError(
            f"needs a cell array 'region' (0 brain, 1 tumour; it has: {have})"
        )
    return TetMesh(
        points=grid.points,
        cells=grid.connectivity.reshape(-1, CORNERS).astype(np.int32),
        region=whole_numbers(grid.cell_data["region"], "region").astype(np.int32),
        point_sets={
            name.removeprefix(SET_PREFIX): whole_numbers(values, f"'{name}'")
            for name, values in grid.field_data.items()
            if name.startswith(SET_PREFIX)
        },
    )


def grid_of(mesh: TetMesh) -> "pv.UnstructuredGrid":
    """Return a mesh as VTK has it, with regions and point sets."""
    import pyvista as pv

    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    grid.cell_data["region"] = mesh.region
    grid.field_data[SPACE] = [RAS]
    for name, ids in mesh.point_sets.items():
        inside = np.zeros(mesh.n_points, dtype=np.uint8)
        inside[ids] = 1
        grid.point_data[f"in_{name}"] = inside
        grid.field_data[SET_PREFIX + name] = ids
    return grid


def save_grid(path: Path, grid: "pv.UnstructuredGrid") -> None:
    """Write a grid; InputError if the name does not end in .vtu."""
    if path.suffix.lower() != ".vtu":
        raise InputError(f"{path}: a mesh is written as .vtu (got '{path.suffix}')")
    write_vtk(path, grid)
