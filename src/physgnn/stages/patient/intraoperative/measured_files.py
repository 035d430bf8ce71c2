"""What was measured in the operating theatre, from files into the space of the scan."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.geometry.surface import Surface
from physgnn.io.medical.linear_transforms import read_rigid_transform, transformed
from physgnn.io.medical.markups import read_point_pairs, states_axes
from physgnn.io.medical.measured_surface import read_surface_points
from physgnn.io.surfaces.formats import read_surface
from physgnn.progress import Log, no_log

Measured = PointPairs | Landmarks | SurfacePoints | WholeSurface | BonePoints
GivenPath = str | Path | None
NOTHING = (
    "nothing was measured of the brain: give --points, --landmarks, --surface, "
    "--whole-surface, --intraoperative or --series"
)
BESIDES = {"initial_transform", "target", "landmarks_target", "bone", "bone_target"}
"""Files that say nothing of a brain by themselves."""
ReadScan = Callable[[Path, FloatArray], Surface]

TRANSFORMED: Mapping[str, bool] = {"both": True, "after": False}
"""Whether points before the shift were measured in the other space, too."""


@dataclass(frozen=True)
class MeasuredFiles:
    """The files of one state of the brain.

    Attributes
    ----------
    points, target, landmarks, landmarks_target, surface, whole_surface, intraoperative
        What was measured of the brain: see `physgnn.register`.
    bone, bone_target
        What was measured of the bone.
    initial_transform : path, optional
        From the space of what was measured to that of the scan.
    """

    points: GivenPath = None
    target: GivenPath = None
    landmarks: GivenPath = None
    landmarks_target: GivenPath = None
    surface: GivenPath = None
    whole_surface: GivenPath = None
    intraoperative: GivenPath = None
    bone: GivenPath = None
    bone_target: GivenPath = None
    initial_transform: GivenPath = None

    @property
    def paths(self) -> dict[str, Path]:
        """What is given, by its name."""
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: Path(path) for name, path in given.items() if path is not None}


def read_measured(
    files: MeasuredFiles,
    *,
    transformed_ends: str = "both",
    scanned: ReadScan | None = None,
    log: Log = no_log,
) -> list[Measured]:
    """Read everything measured of one state, in the space of the scan.

    Parameters
    ----------
    files : MeasuredFiles
        Where it is.
    transformed_ends : str
        A row of `TRANSFORMED`.
    scanned : callable, optional
        From an intraoperative scan and the matrix to the space of the preoperative one
        to the surface of the brain in it.
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
        if files.initial_transform is None
        else read_rigid_transform(files.initial_transform)
    )
    both = TRANSFORMED[transformed_ends]
    found: list[Measured] = []
    if (pairs := _pairs("points", files.points, files.target, log)) is not None:
        found.append(PointPairs(*_ends(pairs, matrix, both)))
    ends = files.landmarks, files.landmarks_target
    if (pairs := _pairs("landmarks", *ends, log, Landmarks)) is not None:
        found.append(Landmarks(*_ends(pairs, matrix, both)))
    if files.surface is not None:
        seen = read_surface_points(files.surface, log=log)
        found.append(SurfacePoints(transformed(matrix, seen.points)))
    if files.whole_surface is not None and files.intraoperative is not None:
        raise InputError(
            "--whole-surface and --intraoperative are one measurement: give one of them"
        )
    if files.whole_surface is not None:
        found.append(whole(read_surface(files.whole_surface), matrix))
    if files.intraoperative is not None and scanned is not None:
        found.append(whole(scanned(Path(files.intraoperative), matrix), matrix))
    if not found:
        raise InputError(NOTHING)
    ends = files.bone, files.bone_target
    if (pairs := _pairs("bone", *ends, log, BonePoints)) is not None:
        known = all(states_axes(end) for end in ends if end is not None)
        found.append(BonePoints(*_ends(pairs, matrix, both), axes_known=known))
        if files.initial_transform is not None and both:
            log(
                "--initial-transform took both ends of the bone points to the scan: "
                "where the first ends are in the scan already, give --transformed after"
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
    path: GivenPath,
    target: GivenPath,
    log: Log,
    kind: type[PointPairs] = PointPairs,
) -> PointPairs | None:
    if path is None:
        if target is not None:
            raise InputError(f"give --{what}, the points before, beside their targets")
        return None
    return read_point_pairs(path, target, kind=kind, log=log)


def _ends(
    pairs: PointPairs, matrix: FloatArray, both: bool
) -> tuple[FloatArray, FloatArray, tuple[str, ...], tuple[str, ...]]:
    source = transformed(matrix, pairs.source) if both else pairs.source
    target = transformed(matrix, pairs.target)
    return source, target, pairs.labels, pairs.left_out
