"""Points measured before and after: what registration starts from."""

from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError


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
            points = np.array(getattr(self, name), dtype=np.float64)
            object.__setattr__(self, name, points)
            if (
                points.ndim != 2
                or points.shape[1] != 3
                or not np.isfinite(points).all()
            ):
                raise InputError(
                    f"{name} points must be finite, (n, 3) (got shape {points.shape})"
                )
        if len(self.source) != len(self.target) or len(self.source) < 3:
            raise InputError(
                "every source point needs its target, and there must be three pairs or "
                f"more (got {len(self.source)} and {len(self.target)})"
            )

    @property
    def displacement(self) -> FloatArray:
        """How each point moved, mm, shape (n, 3)."""
        moved: FloatArray = self.target - self.source
        return moved
