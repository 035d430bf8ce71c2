"""What goes wrong with measurements: outliers, swapped pairs, a navigation that is off.

A row of `KINDS` is what is measured of a case, one of `MEASUREMENT_ERRORS` what is
wrong with it.
"""

from collections.abc import Callable, Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.evaluation.in_silico.cases import Case
from physgnn.geometry.measured import PointPairs, SurfacePoints, WholeSurface

Measured = PointPairs | SurfacePoints | WholeSurface
USUAL = 40  # pairs, of the 50 there are
OUTLIER_SHARE, OUTLIER_MM = 0.1, 15.0
OFFSET_MM, OFFSET_DEG = 3.0, 1.5

KINDS: Mapping[str, tuple[str, ...]] = {
    "pairs": ("pairs",),
    "surface": ("surface",),
    "landmarks": ("landmarks",),
    "whole surface": ("whole surface",),
    "all": ("pairs", "surface", "landmarks"),
}
"""Kinds of measurement, by the names that a registration has for their noise."""


def given(case: Case, kind: str) -> list[Measured]:
    """Return what a row of `KINDS` has of a case."""
    some = PointPairs(case.pairs.source[:USUAL], case.pairs.target[:USUAL])
    every: Mapping[str, Measured] = {
        "pairs": some,
        "surface": case.surface,
        "landmarks": case.landmarks,
        "whole surface": case.whole,
    }
    return [every[name] for name in KINDS[kind]]


def moved_to(one: Measured, to: Callable[[FloatArray], FloatArray]) -> Measured:
    """Return a measurement, what was found after the shift elsewhere."""
    if isinstance(one, PointPairs):
        return type(one)(one.source, to(one.target))
    if isinstance(one, WholeSurface):
        return WholeSurface(to(one.points), one.faces)
    return SurfacePoints(to(one.points))


def clean(measured: list[Measured], rng: np.random.Generator) -> list[Measured]:
    """Leave everything as it is."""
    del rng
    return measured


def outliers(measured: list[Measured], rng: np.random.Generator) -> list[Measured]:
    """Move a tenth of the points in random directions."""

    def astray(points: FloatArray) -> FloatArray:
        chosen = rng.choice(len(points), max(1, round(OUTLIER_SHARE * len(points))))
        away = rng.normal(size=(len(chosen), 3))
        points = points.copy()
        points[chosen] += OUTLIER_MM * away / np.linalg.norm(away, axis=1)[:, None]
        return points

    return [moved_to(one, astray) for one in measured]


def swapped(measured: list[Measured], rng: np.random.Generator) -> list[Measured]:
    """Swap two points of every list of pairs."""

    def exchanged(points: FloatArray) -> FloatArray:
        points = points.copy()
        i, j = rng.choice(len(points), 2, replace=False)
        points[[i, j]] = points[[j, i]]
        return points

    return [
        moved_to(o, exchanged) if isinstance(o, PointPairs) else o for o in measured
    ]


def offset(measured: list[Measured], rng: np.random.Generator) -> list[Measured]:
    """Move everything as a whole, as a navigation that is off does."""
    to, about = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
    turn = Rotation.from_rotvec(np.deg2rad(OFFSET_DEG) * about)
    ends = [o.target if isinstance(o, PointPairs) else o.points for o in measured]
    centre = np.concatenate(ends).mean(axis=0)

    def off(points: FloatArray) -> FloatArray:
        there: FloatArray = centre + turn.apply(points - centre) + OFFSET_MM * to
        return there

    return [moved_to(one, off) for one in measured]


MEASUREMENT_ERRORS: Mapping[
    str, Callable[[list[Measured], np.random.Generator], list[Measured]]
] = {"clean": clean, "outliers": outliers, "swapped": swapped, "offset": offset}
"""From what was measured to what is wrong with it."""
