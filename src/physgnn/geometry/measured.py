"""What was measured of a shift: pairs of points, or where a surface lies now."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_points

FEWEST_PAIRS, FEWEST_POINTS = 3, 10


@dataclass(frozen=True, eq=False)
class PointPairs:
    """Where points were and where they are now.

    Parameters
    ----------
    source : (n, 3) array
        In the rest state, mm, world axes RAS+.
    target : (n, 3) array
        The same points after the shift.

    Raises
    ------
    InputError
        If the two differ in number, there are fewer than three, or one is not finite.
    """

    source: FloatArray
    target: FloatArray

    def __post_init__(self) -> None:
        for name in ("source", "target"):
            points = checked_points(getattr(self, name), f"{name} points")
            object.__setattr__(self, name, points)
        if not len(self.source) == len(self.target) >= FEWEST_PAIRS:
            raise InputError(
                "every source point needs its target, and there must be three pairs or "
                f"more (got {len(self.source)} and {len(self.target)})"
            )

    @property
    def displacement(self) -> FloatArray:
        """How each point moved, mm, shape (n, 3)."""
        moved: FloatArray = self.target - self.source
        return moved


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
        points = checked_points(self.points, "points of a surface")
        object.__setattr__(self, "points", points)
        if len(points) < FEWEST_POINTS:
            raise InputError(
                f"a measured surface needs {FEWEST_POINTS} points or more "
                f"(got {len(points)})"
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
