"""A measured surface: a mesh of 3D Slicer and its kin, or a cloud of points."""

from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.measured import SurfacePoints
from physgnn.io.medical.markups import MARKUP_READERS, read_points
from physgnn.io.surfaces.formats import SURFACE_READERS, read_surface


def read_surface_points(path: str | Path) -> SurfacePoints:
    """Read where a surface lies, RAS+ mm.

    Parameters
    ----------
    path : path
        A surface (.stl, .ply, .obj, .vtp), of which the points and the middles of the
        faces are taken; or points alone: a .csv of three columns, .fcsv, or an
        .mrk.json of one list.

    Raises
    ------
    InputError
        If the file is not what its name says, or holds too few points.
    """
    path = Path(path)
    if path.suffix.lower() in SURFACE_READERS:
        surface = read_surface(path)
        middles = surface.points[surface.faces].mean(axis=1)
        points = np.concatenate([surface.points, middles])
    elif path.name.endswith((".csv", *MARKUP_READERS)):
        points = read_points(path)
    else:
        raise InputError(
            f"{path}: a measured surface must be {', '.join(SURFACE_READERS)}, .csv, "
            f"{' or '.join(MARKUP_READERS)} (got '{path.name}')"
        )
    try:
        return SurfacePoints(points)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
