"""How fine, how tightly and how patiently to solve without elements."""

from dataclasses import dataclass

from physgnn.errors import InputError

RULES = (1, 4)


@dataclass(frozen=True)
class MeshlessOptions:
    """How fine, how tightly and how patiently to solve.

    Attributes
    ----------
    points_per_cell : int
        Integration points a tetrahedron: 1, its middle, or 4, exact to degree 2.
    dilation : float
        Support radius at a place over the mean length of the edges there.
    least_neighbours : int
        Points that every place depends on, at least; ten terms need ten or more.
    tolerance_mm : float
        Bound on the estimated distance of any point from rest.
    force_tolerance : float
        Bound on the force out of balance, over the external force or, where points are
        moved, the reaction.
    max_iterations : int
        Time steps a load step before it is halved.
    min_step : float
        Smallest step in the load factor before the path is given up.

    Raises
    ------
    InputError
        If one of them is out of range.
    """

    points_per_cell: int = 4
    dilation: float = 1.6
    least_neighbours: int = 20
    tolerance_mm: float = 1e-3
    force_tolerance: float = 1e-3
    max_iterations: int = 20_000
    min_step: float = 1e-2

    def __post_init__(self) -> None:
        if self.points_per_cell not in RULES:
            raise InputError(
                f"points_per_cell must be 1 or 4 (got {self.points_per_cell})"
            )
        if not 0.5 <= self.dilation <= 5.0:
            raise InputError(f"dilation must be in 1…5 (got {self.dilation})")
        for name in ("tolerance_mm", "force_tolerance"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} must be > 0 (got {getattr(self, name)})")
        for name, least in (("least_neighbours", 10), ("max_iterations", 1)):
            if not getattr(self, name) >= least:
                raise InputError(
                    f"{name} must be ≥ {least} (got {getattr(self, name)})"
                )
        if not 0 < self.min_step < 1:
            raise InputError(f"min_step must be in (0, 1) (got {self.min_step})")


DEFAULT_MESHLESS = MeshlessOptions()
