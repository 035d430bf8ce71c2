"""A measured surface: where it lies now, not which of its points was where."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError

FEWEST = 10


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points of a surface after a shift, in no order.

    Parameters
    ----------
    points : (n, 3) array
        mm, world axes RAS+.

    Raises
    ------
    InputError
        If there are fewer than ten, or one is not finite.
    """

    points: FloatArray

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=np.float64)
        object.__setattr__(self, "points", points)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise InputError(
                "points of a surface must be finite, three numbers each (got shape "
                f"{points.shape})"
            )
        if len(points) < FEWEST:
            raise InputError(
                f"a measured surface needs {FEWEST} points or more (got {len(points)})"
            )

    def thinned(self, count: int) -> "SurfacePoints":
        """Return so many points, evenly spread, or all if there are not more."""
        if len(self.points) <= count:
            return self
        return SurfacePoints(self.points[farthest_points(self.points, count=count)])


def farthest_points(
    points: FloatArray, *, count: int | None = None, spacing: float = 0.0
) -> IntArray:
    """Take the point farthest from those taken, again and again.

    Parameters
    ----------
    points : (n, 3) array
        To choose from; the first is taken.
    count : int, optional
        How many to take, at most.
    spacing : float
        Stop when every point is within this of a taken one.

    Returns
    -------
    integer array
        Indices, in the order they were taken.
    """
    taken = [0]
    nearest = np.linalg.norm(points - points[0], axis=1)
    while nearest.max() > spacing and (count is None or len(taken) < count):
        taken.append(int(nearest.argmax()))
        latest = np.linalg.norm(points - points[taken[-1]], axis=1)
        nearest = np.minimum(nearest, latest)
    return np.array(taken, dtype=np.int64)
