"""A plan: points of any file, and how the same file reads with these points elsewhere.

Readers keep the whole file and change what says where points are. So labels, colours,
scalars, display settings and whatever else a program left there stay as they are.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.array_checks import checked_points

NO_LINKS = np.empty((0, 2), np.int64)


@dataclass(frozen=True, eq=False)
class Plan:
    """Points of a file.

    Parameters
    ----------
    points : (n, 3) array
        RAS+, mm.
    rewritten : callable
        From points like these to the bytes of the file that has them instead.
    labels : tuple of str
        What messages call them; none where points have no names, as in models.
    what : str
        What messages call a point that has none, such as "vertex".
    links : (m, 2) integer array
        Points that a curve joins, one after the other.

    Raises
    ------
    InputError
        If there is no point, or a coordinate is not finite.
    """

    points: FloatArray
    rewritten: Callable[[FloatArray], bytes]
    labels: tuple[str, ...] = ()
    what: str = "point"
    links: IntArray = field(default_factory=NO_LINKS.copy)

    def __post_init__(self) -> None:
        if len(self.points) == 0:
            raise InputError(f"holds no {self.what} that is placed: export it again")
        object.__setattr__(self, "points", checked_points(self.points, "points"))

    def name(self, i: int) -> str:
        """Return what a point is called: its label, or its number from 1."""
        label = self.labels[i] if i < len(self.labels) else ""
        return f"'{label}'" if label else f"{self.what} {i + 1}"

    def moved_to(self, points: FloatArray) -> "Plan":
        """Return the same plan with its points elsewhere."""
        return replace(self, points=points)

    def as_bytes(self) -> bytes:
        """Return the file."""
        return self.rewritten(self.points)


def shown(number: float) -> str:
    """Return a coordinate as text: to 1e-9 mm, without digits of rounding."""
    return repr(round(float(number), 9) + 0.0)
