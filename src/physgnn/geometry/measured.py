"""What was measured of a shift: pairs of points, or where a surface lies now."""

from dataclasses import dataclass
from typing import ClassVar

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
    labels : tuple of str
        The name of each; by default its number, from 1.
    left_out : tuple of str
        Names of other pairs that were listed and have no place at one end.

    Raises
    ------
    InputError
        If they differ in number, there are fewer than three, or one is not finite.
    """

    source: FloatArray
    target: FloatArray
    labels: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    fewest: ClassVar[int] = FEWEST_PAIRS

    def __post_init__(self) -> None:
        for name in ("source", "target"):
            points = checked_points(getattr(self, name), f"{name} points")
            object.__setattr__(self, name, points)
        if not len(self.source) == len(self.target) >= self.fewest:
            raise InputError(
                "every source point needs its target, and there must be "
                f"{self.fewest} pairs or more (got {len(self.source)} and "
                f"{len(self.target)})"
            )
        names = self.labels or [str(i + 1) for i in range(len(self.source))]
        object.__setattr__(self, "labels", tuple(names))
        if len(self.labels) != len(self.source):
            raise InputError(
                "every pair needs a label, or none has one "
                f"(got {len(self.labels)} labels of {len(self.source)} pairs)"
            )

    @property
    def displacement(self) -> FloatArray:
        """How each point moved, mm, shape (n, 3)."""
        moved: FloatArray = self.target - self.source
        return moved


class Landmarks(PointPairs):
    """Pairs of points inside a brain, such as those seen by ultrasound; one will do."""

    fewest: ClassVar[int] = 1


@dataclass(frozen=True, eq=False)
class BonePoints(PointPairs):
    """Pairs of points that cannot move with a brain: on the skull, or fixed to it.

    Where they are in the scan, and where the navigation finds them now.

    Parameters
    ----------
    source, target, labels, left_out
        As of `PointPairs`.
    axes_known : bool
        Whether it is known that they are in RAS, as where a file states its axes.
    """

    axes_known: bool = False

    fewest: ClassVar[int] = 1


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points of the exposed surface after a shift, in no order.

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
        """Return so many of the points, or all if there are not more.

        Which ones does not depend on where they lie, so that a point which moves by a
        little changes the result by a little.
        """
        if len(self.points) <= count:
            return self
        order = np.random.default_rng(0).permutation(len(self.points))
        return SurfacePoints(self.points[np.sort(order[:count])])


@dataclass(frozen=True, eq=False)
class WholeSurface(SurfacePoints):
    """The whole surface of a brain after a shift, such as of an intraoperative scan.

    Parameters
    ----------
    points : (n, 3) array
        Its points, mm, world axes RAS+.
    faces : (m, 3) array
        Its triangles.

    Raises
    ------
    InputError
        If there are fewer than ten points, or one is not finite.
    """

    faces: IntArray


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
