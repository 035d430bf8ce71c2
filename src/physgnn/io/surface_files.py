"""Surfaces from STL, PLY, OBJ and VTP files."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyvista as pv

from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.ply import read_ply
from physgnn.io.stl import read_stl
from physgnn.io.vtk_reader import read_vtk

HEAD_BYTES = 4096


def read_surface(path: str | Path) -> Surface:
    """Read a triangulated surface in mm; the format is the suffix's.

    Polygons are cut into triangles and equal points made one. Whether the surface
    can be meshed is for `physgnn.geometry.check_surface` to say.

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
    try:
        return reader(path)
    except InputError as error:
        named = str(error).startswith(str(path))
        raise InputError(str(error) if named else f"{path}: {error}") from error


def _read_vtp(path: Path) -> Surface:
    if b'type="PolyData"' not in _head(path):
        raise _not("VTP", path, "it is no VTK XML PolyData")
    return _with_vtk(path)


def _read_obj(path: Path) -> Surface:
    data = path.read_bytes()
    keys = {line.split(b" ", 1)[0] for line in data.splitlines()}
    if b"\0" in data or not {b"v", b"f"} <= keys:
        raise _not("OBJ", path, "it has no 'v' and 'f' lines")
    return _with_vtk(path)


SURFACE_READERS: Mapping[str, Callable[[Path], Surface]] = {
    ".stl": read_stl,
    ".ply": read_ply,
    ".obj": _read_obj,
    ".vtp": _read_vtp,
}


def _with_vtk(path: Path) -> Surface:
    data = read_vtk(path)
    if not isinstance(data, pv.PolyData):
        raise _not("surface", path, f"it holds {type(data).__name__}")
    points = np.asarray(data.points, dtype=np.float64)
    faces = data.triangulate().regular_faces if data.n_faces else np.empty((0, 3))
    if len(points) == 0 or len(faces) == 0:
        raise InputError(f"{path}: the surface is empty: export it again")
    return merge_points(points, faces.astype(np.int32))


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(HEAD_BYTES)


def _not(kind: str, path: Path, reason: str) -> InputError:
    return InputError(
        f"{path}: expected {kind}, but {reason}: rename it or export it again"
    )
