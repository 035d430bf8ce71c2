"""Surfaces from STL, PLY, OBJ, VTP, legacy VTK, Gmsh, Abaqus and OFF files.

3D Slicer writes models in LPS and says so by the words SPACE=LPS in a comment, or a
field of that name in VTP; such files are turned to RAS. Others are taken as they are.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from physgnn.errors import InputError
from physgnn.geometry.surface import Surface
from physgnn.imaging.transforms import points_to_ras
from physgnn.io.surfaces.mesh_faces import read_mesh_faces
from physgnn.io.surfaces.obj import read_obj
from physgnn.io.surfaces.ply import read_ply
from physgnn.io.surfaces.stl import read_stl
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.vtk.reader import read_vtk
from physgnn.io.vtk.vtp import read_vtp

HEAD_BYTES = 4096

SURFACE_READERS: Mapping[str, Callable[[Path], Surface]] = {
    ".stl": read_stl,
    ".ply": read_ply,
    ".obj": read_obj,
    ".vtp": read_vtp,
    ".vtk": read_mesh_faces,
    ".msh": read_mesh_faces,
    ".inp": read_mesh_faces,
    ".off": read_mesh_faces,
}


def read_surface(path: str | Path) -> Surface:
    """Read a triangulated surface in mm; the format is the suffix's.

    Polygons are cut into triangles and equal points made one, sorted by (x, y, z).
    Whether the surface can be meshed is for `physgnn.geometry.check_surface` to say.

    Parameters
    ----------
    path : path
        The file: .stl, .ply, .obj or .vtp; points in mm.

    Returns
    -------
    Surface
        Points (n_points, 3), mm, and triangles (n_faces, 3).

    Raises
    ------
    InputError
        If the file is missing, of an unknown format, or not what its name says, or
        holds no faces.
    """
    path = Path(path)
    reader = SURFACE_READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"{path}: a surface must be one of {', '.join(SURFACE_READERS)} "
            f"(got '{path.suffix}')"
        )
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    # what a surface must be is said without the file's name
    with reading(path, f"a surface, {path.suffix}"):
        surface = reader(path)
        return Surface(points_to_ras(surface.points, space_of(path)), surface.faces)


def space_of(path: Path) -> str:
    """Return the axes that a surface's points are in; RAS if its file does not say."""
    if SURFACE_READERS.get(path.suffix.lower()) is read_mesh_faces:
        return "RAS"  # turned already
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    if path.suffix.lower() == ".vtp" and b'Name="SPACE"' in head:
        said = read_vtk(path).field_data.get("SPACE")
        return "RAS" if said is None or len(said) == 0 else str(said[0])
    return "LPS" if b"SPACE=LPS" in head else "RAS"
