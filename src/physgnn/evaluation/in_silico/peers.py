"""What registrations are compared with: rigid motions and thin-plate splines."""

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.geometry.measured import PointPairs, SurfacePoints

ICP_STEPS = 30
SMOOTHINGS = np.logspace(0, 9, 10)  # of a spline; one is chosen by cross-validation
FOLDS = 10


def rigid(pairs: PointPairs, points: FloatArray) -> FloatArray:
    """Return the displacement of the rigid motion that fits pairs best.

    Parameters
    ----------
    pairs : PointPairs
        mm; without reflection, by least squares (Kabsch, Acta Cryst. A32, 1976).
    points : (n, 3) array
        Where to, mm.
    """
    middle, to = pairs.source.mean(axis=0), pairs.target.mean(axis=0)
    turn, _ = Rotation.align_vectors(pairs.target - to, pairs.source - middle)
    moved: FloatArray = turn.apply(points - middle) + to - points
    return moved


def nearest_pairs(surface: SurfacePoints, body: FloatArray) -> PointPairs:
    """Pair each measured point with the nearest of a body's, (n, 3), mm."""
    return PointPairs(body[cKDTree(body).query(surface.points)[1]], surface.points)


def rigid_icp(
    surface: SurfacePoints, body: FloatArray, points: FloatArray
) -> FloatArray:
    """Return the displacement of the rigid motion found by matching again and again.

    Iterated closest points (Besl & McKay, IEEE PAMI 14, 1992).

    Parameters
    ----------
    surface : SurfacePoints
        Where the surface lies, mm.
    body : (m, 3) array
        Points of the surface at rest, mm.
    points : (n, 3) array
        Where to, mm.
    """
    seen, moved = body.copy(), points.copy()
    for _ in range(ICP_STEPS):
        pairs = nearest_pairs(surface, seen)
        seen, moved = seen + rigid(pairs, seen), moved + rigid(pairs, moved)
    return moved - points


def spline(
    pairs: PointPairs, points: FloatArray, anchors: FloatArray | None = None
) -> FloatArray:
    """Return the displacement of a thin-plate spline.

    Its smoothing is chosen by ten-fold cross-validation on the pairs.

    Parameters
    ----------
    pairs : PointPairs
        mm.
    points : (n, 3) array
        Where to, mm.
    anchors : (k, 3) array, optional
        Points that stay, mm.
    """
    n = len(pairs.source)
    extra = np.empty((0, 3)) if anchors is None else anchors
    x = np.concatenate([pairs.source, extra])
    d = np.concatenate([pairs.displacement, np.zeros_like(extra)])

    def left_out(smoothing: float) -> float:
        residual = []
        order = np.random.default_rng(0).permutation(n)
        for held_out in np.array_split(order, FOLDS):
            kept = np.setdiff1d(np.arange(len(x)), held_out)
            model = RBFInterpolator(x[kept], d[kept], smoothing=smoothing)
            residual.append(model(x[held_out]) - d[held_out])
        return float((np.concatenate(residual) ** 2).sum())

    best = min(SMOOTHINGS, key=left_out)
    found: FloatArray = RBFInterpolator(x, d, smoothing=best)(points)
    return found
