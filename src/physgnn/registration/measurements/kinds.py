"""The kinds of measurement: a row of the table each.

To add one, write a class with the attributes of `Measurement` and a row.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_points
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
)
from physgnn.geometry.plausibility import check_same_units
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body
from physgnn.registration.measurements.bone import check_bone
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.measurements.points import (
    measured_landmarks,
    measured_pairs,
)
from physgnn.registration.measurements.surfaces import (
    MeasuredSurface,
    MeasuredWholeSurface,
)

Measured = PointPairs | Landmarks | SurfacePoints | WholeSurface
AnyMeasured = Measured | BonePoints
Noise = float | Mapping[str, float]
SMALLEST_NOISE_MM, LARGEST_NOISE_MM = 1e-4, 20.0  # nothing measures finer
DEFAULT_NOISE_MM = 1.0


def _pairs(body: Body, measured: Any) -> Measurement:
    return measured_pairs(body, measured)


def _landmarks(body: Body, measured: Any) -> Measurement:
    return measured_landmarks(body, measured)


def _surface(body: Body, measured: Any) -> Measurement:
    return MeasuredSurface(body.mesh, body.fixed, measured)


def _whole_surface(body: Body, measured: Any) -> Measurement:
    return MeasuredWholeSurface(body.mesh, measured)


KINDS: Mapping[type, Callable[[Body, Any], Measurement]] = {
    PointPairs: _pairs,
    Landmarks: _landmarks,
    SurfacePoints: _surface,
    WholeSurface: _whole_surface,
}


def measurements_of(
    body: Body, measured: Measured | Sequence[Measured]
) -> list[Measurement]:
    """Return everything measured, placed in a body.

    Raises
    ------
    InputError
        If nothing is given, or something is in another unit than the body or far from
        it.
    """
    given = measured if isinstance(measured, Sequence) else [measured]
    if not given:
        raise InputError("nothing was measured of the brain: give points or a surface")
    for one in given:
        _check_units(body.mesh, one)
    return [KINDS[type(one)](body, one) for one in given]


def parted(
    mesh: TetMesh, given: AnyMeasured | Sequence[AnyMeasured]
) -> tuple[list[Measured], BonePoints | None]:
    """Return what was measured of the brain, and of the bone.

    Raises
    ------
    InputError
        If points of the bone cannot be such, or are given twice.
    """
    every = given if isinstance(given, Sequence) else [given]
    bone = [one for one in every if isinstance(one, BonePoints)]
    if len(bone) > 1:
        raise InputError(f"give all bone points as one (got {len(bone)} lists of them)")
    for one in bone:
        check_bone(mesh, one)
    brain = [one for one in every if not isinstance(one, BonePoints)]
    for one in bone:
        _check_no_brain(one, brain)
    return brain, bone[0] if bone else None


def _check_no_brain(bone: BonePoints, brain: Sequence[Measured]) -> None:
    """Raise InputError if bone points are points of the brain, given once more."""
    ends = np.hstack([bone.source, bone.target])
    for one in brain:
        if not isinstance(one, PointPairs):
            continue
        same = ends[:, None] == np.hstack([one.source, one.target])
        if same.all(axis=2).any():
            raise InputError(
                "bone points must be other points than those of the brain (one pair is "
                "given as both): bone does not move with the brain"
            )


def left_out_of(given: Sequence[AnyMeasured]) -> tuple[str, ...]:
    """Return the names of pairs that were listed and have no place at one end."""
    pairs = [one for one in given if isinstance(one, PointPairs)]
    return tuple(name for one in pairs for name in one.left_out)


def moved(measured: Measured, to: Callable[[FloatArray], FloatArray]) -> Measured:
    """Return a measurement, what was found after the shift elsewhere.

    Parameters
    ----------
    measured : PointPairs, Landmarks, SurfacePoints or WholeSurface
        Whatever a row of `KINDS` takes.
    to : callable
        From points (n, 3) to where they are put, mm.
    """
    if isinstance(measured, PointPairs):
        return replace(measured, target=to(measured.target))
    return replace(measured, points=to(measured.points))


def _check_units(mesh: TetMesh, measured: Measured) -> None:
    if isinstance(measured, PointPairs):
        for end, points in (("before", measured.source), ("after", measured.target)):
            check_same_units(points, mesh.points, f"measured points ({end})")
    else:
        surface = mesh.points[boundary_points(mesh)]
        check_same_units(measured.points, surface, "measured surface")


def noises_of(kinds: Sequence[str], noise_mm: Noise) -> list[float]:
    """Return the noise of each measurement, mm.

    Parameters
    ----------
    kinds : sequence of str
        Of everything measured.
    noise_mm : float or mapping
        Of all, or of each kind by its name; 1 mm where it is not named.

    Raises
    ------
    InputError
        If one is not in [0.0001, 20] mm, of a kind that was not measured either.
    """
    if not isinstance(noise_mm, Mapping):
        noise_mm = dict.fromkeys(kinds, noise_mm)
    for kind, noise in noise_mm.items():
        if not SMALLEST_NOISE_MM <= noise <= LARGEST_NOISE_MM:
            raise InputError(
                f"noise_mm of {kind} must be in [{SMALLEST_NOISE_MM:g}, "
                f"{LARGEST_NOISE_MM:g}] (got {noise})"
            )
    return [float(noise_mm.get(kind, DEFAULT_NOISE_MM)) for kind in kinds]
