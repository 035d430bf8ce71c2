"""How well a registration meets what was measured: the evidence for its status."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import chdtrc, ndtr, ndtri

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.measured import farthest_points
from physgnn.prediction.measured_evidence import (
    LEAST_CHANCE,
    SAME_PLACE_MM,
    BoneFit,
    MeasurementFit,
    RigidOffset,
)
from physgnn.registration.inference.bone_offset import BoneOffset
from physgnn.registration.inference.heavy_tails import RobustFit
from physgnn.registration.inference.rows import MeasuredRows
from physgnn.registration.measurements.observation import Measurement
from physgnn.registration.measurements.points import MeasuredPoints

# The stated noise may be too small by this factor before a misfit counts against it:
# a tracker's noise is known no better.
NOISE_KNOWN_WITHIN = 1.5
# A dent that the body cannot follow is lost in the mean of a large surface's misfit.
AREA_MM = 20.0  # radius of what is averaged, about a width of the load modes
FEWEST_OF_AREA = 10
LEAST_BUMP_MM = 1.5  # less may be the mesh's coarseness


def fit_of(
    measured: Sequence[Measurement],
    rows: MeasuredRows,
    fit: RobustFit,
    offset: RigidOffset,
    bone: BoneFit | None = None,
) -> MeasurementFit:
    """Return how well a displacement meets what was measured.

    Outliers count as not measured.

    Parameters
    ----------
    measured : sequence of Measurement
        Everything measured.
    rows : MeasuredRows
        About the registered state.
    fit : RobustFit
        Of the last step.
    offset : RigidOffset
        Of the navigation.
    bone : BoneFit, optional
        Of points of the bone, if there were any.
    """
    kept = ~fit.outliers
    few = _apart(np.concatenate([one.points for one in measured])[kept])
    counts = np.cumsum([0, *(n for n, _ in rows.blocks)])
    parts = [slice(*ends) for ends in pairwise(counts)]
    ratios = [_misfit(rows, fit, part, kept) for part in parts]
    worst = min(ratios, key=lambda found: found[1])
    translation, as_well = _whole_translation(measured, parts, kept, rows, fit)
    return MeasurementFit(
        n_places=len(few),
        spread_mm=second_spread(few),
        distance_mm=max(one.distance_mm for one in measured),
        translation_mm=translation,
        translation_misfit=as_well,
        misfit_ratio=worst[0],
        chance=worst[1],
        outlier_share=max(float(fit.outliers[part].mean()) for part in parts),
        offset=offset,
        sunk_mm=max(one.sunk_mm for one in measured),
        bump_mm=_largest_bump(measured, rows, fit),
        bone=bone,
        exchanged_mm=max(
            (one.exchanged_mm for one in measured if isinstance(one, MeasuredPoints)),
            default=0.0,
        ),
    )


def bone_fit_of(told: BoneOffset) -> BoneFit:
    """Return how well points of the bone agree on an offset.

    Parameters
    ----------
    told : BoneOffset
        What they say.
    """
    kept = ~told.fit.outliers
    few = _apart(told.bone.source[kept])
    every = slice(0, len(kept))
    chance = _misfit(told.rows, told.fit, every, kept)[1] if kept.any() else 0.0
    return BoneFit(
        n_points=len(few),
        spread_mm=second_spread(few) if len(few) else 0.0,
        misfit_mm=told.misfit_mm,
        chance=chance,
        outlier_share=float(told.fit.outliers.mean()),
    )


def _apart(points: FloatArray) -> FloatArray:
    """Return points that are not within 1 mm of each other."""
    if not len(points):
        return points
    return points[farthest_points(points, spacing=SAME_PLACE_MM)]


def _largest_bump(
    measured: Sequence[Measurement], rows: MeasuredRows, fit: RobustFit
) -> float:
    """Return the `bump_of` of the surface that has the largest, mm."""
    found, first = [0.0], 0
    for one, (n, k) in zip(measured, rows.blocks, strict=True):
        data = slice(first, first + n * k)
        first += n * k
        if k == 1:  # across a surface
            found.append(bump_of(one.points, fit.misfit[data], rows.noise[data]))
    return max(found)


def bump_of(points: FloatArray, misfit: FloatArray, noise: FloatArray) -> float:
    """Return how far the area of a surface that fits worst lies off to one side, mm.

    Of every place the median is taken over those within `AREA_MM`, of which a few bad
    points are no more than a few. It is 0 where the noise that the whole surface has,
    or the stated one if that is less, may be the cause alone.

    Parameters
    ----------
    points : (n, 3) array
        Places, mm.
    misfit : (n,) array
        Of each along the normal, over its noise.
    noise : (n,) array
        Of each, mm.
    """
    near = cKDTree(points).query_ball_point(points, AREA_MM)
    count = np.array([len(one) for one in near])
    middle = np.abs([np.median(misfit[one]) for one in near])
    usual = min(float(np.median(np.abs(misfit))) / ndtri(0.75), NOISE_KNOWN_WITHIN)
    deviation = np.sqrt(np.pi / 2 / count) * max(usual, np.finfo(float).tiny)
    # as many areas were looked at as there is room for
    chance = 2 * ndtr(-middle / deviation) * len(points) / count
    away = middle * noise
    off = (chance < LEAST_CHANCE) & (count >= FEWEST_OF_AREA) & (away > LEAST_BUMP_MM)
    return float(away[off].max()) if off.any() else 0.0


def _misfit(
    rows: MeasuredRows, fit: RobustFit, part: slice, kept: BoolArray
) -> tuple[float, float]:
    """Return the squared misfit of some places over what noise lets expect, its chance.

    Those that are outliers are left out.
    """
    chosen = np.zeros(len(kept), dtype=bool)
    chosen[part] = kept[part]
    data = rows.spread(chosen.astype(float)) > 0
    freedom = float((1.0 - fit.posterior.leverage[data]).sum())
    square = float((fit.misfit[data] ** 2).sum())
    ratio = square / max(freedom, 1e-12)
    return ratio, float(chdtrc(max(freedom, 1e-12), square / NOISE_KNOWN_WITHIN**2))


def _whole_translation(
    measured: Sequence[Measurement],
    parts: Sequence[slice],
    kept: BoolArray,
    rows: MeasuredRows,
    fit: RobustFit,
) -> tuple[float, float]:
    """Return the translation nearest to all pairs, and its misfit over the body's."""
    moved = [
        one.moved[kept[part]]
        for one, part in zip(measured, parts, strict=True)
        if isinstance(one, MeasuredPoints)
    ]
    if len(moved) < len(measured) or not sum(map(len, moved)):
        return 0.0, np.inf
    translation, misfit = best_translation(np.concatenate(moved))
    data = rows.spread(kept.astype(float)) > 0
    square = float(((fit.misfit * rows.noise)[data] ** 2).sum())
    freedom = float((1.0 - fit.posterior.leverage[data]).sum())
    elastic = square / max(freedom, 1.0)
    return translation, misfit / max(elastic, np.finfo(float).tiny)


def second_spread(places: FloatArray) -> float:
    """Return the standard deviation of places along their second principal axis, mm."""
    away = places - places.mean(axis=0)
    sizes = np.linalg.svd(away, compute_uv=False)
    return float(sizes[1] / np.sqrt(len(places))) if len(sizes) > 1 else 0.0


def best_translation(moved: FloatArray) -> tuple[float, float]:
    """Return the length of the translation nearest to displacements, and its misfit.

    The misfit is the sum of squares that is left, over its degrees of freedom, mm².
    """
    mean = moved.mean(axis=0)
    left = float(((moved - mean) ** 2).sum()) / max(moved.size - 3, 1)
    return float(np.linalg.norm(mean)), left
