"""What was measured in the operating theatre, from files into the space of the scan."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.measured import (
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.geometry.surface import Surface
from physgnn.io.medical.linear_transforms import read_rigid_transform, transformed
from physgnn.io.medical.markups import read_point_pairs
from physgnn.io.medical.measured_surface import read_surface_points
from physgnn.io.surfaces.formats import read_surface
from physgnn.progress import Log, no_log

Measured = PointPairs | Landmarks | SurfacePoints | WholeSurface
GivenPath = str | Path | None

TRANSFORMED: Mapping[str, bool] = {"both": True, "after": False}
"""Whether points before the shift were measured in the other space, too."""


def read_measured(
    *,
    points: tuple[GivenPath, GivenPath] = (None, None),
    landmarks: tuple[GivenPath, GivenPath] = (None, None),
    surface: GivenPath = None,
    whole_surface: GivenPath = None,
    initial_transform: GivenPath = None,
    transformed_ends: str = "both",
    log: Log = no_log,
) -> list[Measured]:
    """Read everything measured, in the space of the scan.

    Parameters
    ----------
    points, landmarks : (path, path)
        The file of points before, or of both ends, and that of points after.
    surface, whole_surface, initial_transform
        See `physgnn.register`.
    transformed_ends : str
        A row of `TRANSFORMED`.
    log : callable
        Called with what was left out.

    Raises
    ------
    InputError
        If nothing is given, or a file cannot be used.
    """
    if transformed_ends not in TRANSFORMED:
        raise InputError(
            f"transformed must be one of {', '.join(TRANSFORMED)} "
            f"(got '{transformed_ends}')"
        )
    matrix = (
        np.eye(4)
        if initial_transform is None
        else read_rigid_transform(initial_transform)
    )
    both = TRANSFORMED[transformed_ends]
    found: list[Measured] = []
    if (pairs := _pairs("points", points, log)) is not None:
        found.append(PointPairs(*_ends(pairs, matrix, both)))
    if (pairs := _pairs("landmarks", landmarks, log, Landmarks)) is not None:
        found.append(Landmarks(*_ends(pairs, matrix, both)))
    if surface is not None:
        seen = read_surface_points(surface, log=log)
        found.append(SurfacePoints(transformed(matrix, seen.points)))
    if whole_surface is not None:
        found.append(whole(read_surface(whole_surface), matrix))
    if not found:
        raise InputError(
            "nothing was measured: give --points, --landmarks, --surface or "
            "--whole-surface"
        )
    return found


def whole(surface: Surface, matrix: FloatArray) -> WholeSurface:
    """Return a segmented brain's surface as a measurement.

    Parameters
    ----------
    surface : Surface
        Such as that of an intraoperative scan, mm.
    matrix : (4, 4) array
        Takes it to the space of the scan.
    """
    points = transformed(matrix, surface.points)
    return WholeSurface(points, surface.faces.astype(np.int64))


def _pairs(
    what: str,
    files: tuple[GivenPath, GivenPath],
    log: Log,
    kind: type[PointPairs] = PointPairs,
) -> PointPairs | None:
    path, target = files
    if path is None:
        if target is not None:
            raise InputError(f"give --{what}, the points before, beside their targets")
        return None
    return read_point_pairs(path, target, kind=kind, log=log)


def _ends(
    pairs: PointPairs, matrix: FloatArray, both: bool
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    source = transformed(matrix, pairs.source) if both else pairs.source
    return source, transformed(matrix, pairs.target), pairs.labels
