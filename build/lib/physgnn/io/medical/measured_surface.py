"""A measured surface: a mesh of 3D Slicer and its kin, or a cloud of points."""

from pathlib import Path

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.measured import SurfacePoints
from physgnn.io.medical.markups import POINT_READERS, read_points
from physgnn.io.surfaces.formats import SURFACE_READERS, read_surface
from physgnn.io.untrusted.input_errors import reading
from physgnn.progress import Log, no_log


def read_surface_points(path: str | Path, *, log: Log = no_log) -> SurfacePoints:
    """Read where a surface lies, RAS+ mm.

    Parameters
    ----------
    path : path
        A surface, see `physgnn.io.surfaces.formats`, of which the points and the
        middles of the faces are taken; or points alone: a .csv of three columns, a .tag
        of one volume, .fcsv, or an .mrk.json of one list.
    log : callable
        Called with which points were left out, and why.

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
    elif path.name.lower().endswith(tuple(POINT_READERS)):
        points = read_points(path, log=log)
    else:
        raise InputError(
            f"{path}: a measured surface must be {', '.join(SURFACE_READERS)}, "
            f"{', '.join(POINT_READERS)} (got '{path.name}')"
        )
    with reading(path, "a measured surface"):
        return SurfacePoints(points)
