"""Tetrahedra of another program's mesh, with the numbers and names of its regions."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import signed_volumes
from physgnn.io.meshes.reader import BY_MESHIO, BY_VTK, MeshFile, read_mesh_file
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.numbers import whole_numbers
from physgnn.io.vtk.data import Array
from physgnn.progress import Log, no_log

MESH_SUFFIXES = tuple(s for s in (*BY_MESHIO, *BY_VTK) if s != ".off")
CORNERS = 4
TETRA, QUADRATIC = 10, 24
SOLIDS = {11: "voxels", 12: "hexahedra", 13: "wedges", 14: "pyramids", 25: "hexahedra"}
# Cell arrays that hold regions, the first of these that is there.
REGION_ARRAYS = (
    *("region", "gmsh:physical", "element set", "medit:ref", "labels", "label"),
    *("material", "MaterialIds", "gmsh:geometrical"),
)


@dataclass(frozen=True, eq=False)
class Tetrahedra:
    """Cells that are not yet a mesh of ours: numbers are not regions yet.

    Attributes
    ----------
    points : (n_points, 3) array
        As the file has them, RAS+; some may belong to no cell.
    cells : (n_cells, 4) integer array
        All of positive volume, unless one has none.
    numbers : (n_cells,) integer array
        What the file says of each cell; 0 if it says nothing.
    array : str
        The cell array they come from, empty if there is none.
    names : mapping of number to str
        What the file calls them.
    point_sets : mapping of str to integer array
        Named sets of points.
    """

    points: FloatArray
    cells: IntArray
    numbers: IntArray
    array: str = ""
    names: Mapping[int, str] = field(default_factory=dict)
    point_sets: Mapping[str, IntArray] = field(default_factory=dict)


def read_tetrahedra(path: str | Path, *, log: Log = no_log) -> Tetrahedra:
    """Read the tetrahedra of a mesh.

    Parameters
    ----------
    path : path
        .msh (Gmsh 2 and 4), .inp (Abaqus), .mesh (Medit), .vtk or .vtu.
    log : callable
        Called with what was repaired and what is not used.

    Raises
    ------
    InputError
        If it cannot be read, has no tetrahedra or other solid cells, or several cell
        arrays may hold the regions.
    """
    path = Path(path)
    with reading(path, f"a mesh, {path.suffix}"):
        return _tetrahedra(read_mesh_file(path), log)


def _tetrahedra(file: MeshFile, log: Log) -> Tetrahedra:
    data = file.data
    solids = {SOLIDS[kind] for kind in np.unique(data.cell_types) if kind in SOLIDS}
    if solids:
        raise InputError(
            "every solid cell must be a tetrahedron (it has "
            f"{', '.join(sorted(solids))}): split them, such as with Gmsh"
        )
    chosen = np.isin(data.cell_types, (TETRA, QUADRATIC))
    if not chosen.any():
        raise InputError(
            "a mesh must have tetrahedra (this has none): give a surface by --brain"
        )
    lengths, quadratic = np.diff(data.offsets), (data.cell_types == QUADRATIC).sum()
    if (lengths[chosen] < CORNERS).any():
        raise InputError("a tetrahedron must have four corners")
    cells = data.connectivity[data.offsets[:-1][chosen, None] + np.arange(CORNERS)]
    if quadratic:
        log(f"{quadratic} cells have points at the middles of edges: not used")
    if (~chosen).any():
        log(f"{(~chosen).sum()} faces, edges and points beside the cells: not used")
    inverted = signed_volumes(data.points, cells) < 0
    cells[inverted, :2] = cells[inverted, 1::-1]
    if inverted.any():
        log(f"{inverted.sum()} cells were inside out: turned")
    array = _region_array({n: v for n, v in data.cell_data.items() if v.ndim == 1})
    numbers = np.zeros(len(cells), np.int64)
    if array:
        numbers = whole_numbers(data.cell_data[array][chosen], f"'{array}'")
    names = file.names.get(array, {})
    return Tetrahedra(data.points, cells, numbers, array, names, file.point_sets)


def _region_array(arrays: Mapping[str, Array]) -> str:
    known = next((name for name in REGION_ARRAYS if name in arrays), "")
    if known:
        return known
    whole = [name for name, v in arrays.items() if v.dtype.kind in "iu"]
    if len(whole) > 1:
        raise InputError(
            f"one cell array must hold the regions (it has {', '.join(whole)}): call "
            "it 'region'"
        )
    return whole[0] if whole else ""
