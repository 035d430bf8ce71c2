"""Gravity with a level of cerebrospinal fluid: the brain sags as the fluid drains."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh

UNIT = 1e-15  # how far rounding may take the length of a direction from 1
STANDARD_GRAVITY = 9.80665  # m/s², CODATA; times 1e-9 it turns kg/m³ into N/mm³


@dataclass(frozen=True)
class Gravity:
    """Weight, less the buoyancy of what lies below the fluid's level.

    A cell is pulled by ρ V and lifted by ρ_f v, v the part of its current volume that
    is under water as the body now lies; its four corners carry equal parts.

    Parameters
    ----------
    direction : (x, y, z)
        Where things fall, world axes; any length > 0.
    density_kg_m3 : float
        ρ. 1000 as Salehi & Giannacopoulos 2022 take it.
    fluid_level_mm : float or None
        Height of the surface of the fluid, measured from the origin against
        `direction`; None if there is no fluid.
    fluid_density_kg_m3 : float
        ρ_f; by default tissue under water weighs nothing.

    Raises
    ------
    InputError
        If the direction is zero or a number is out of range.
    """

    direction: tuple[float, float, float]
    density_kg_m3: float = 1000.0
    fluid_level_mm: float | None = None
    fluid_density_kg_m3: float = 1000.0

    def __post_init__(self) -> None:
        direction = np.asarray(self.direction, dtype=np.float64)
        length = float(np.linalg.norm(direction))
        if direction.shape != (3,) or not 0 < length < np.inf:
            raise InputError(
                f"direction must be three numbers, not all 0 (got {self.direction})"
            )
        # A unit vector stays as it is, so that a copy is the same to the last bit.
        if abs(length - 1) > UNIT:
            direction = direction / length
        object.__setattr__(self, "direction", tuple(direction.tolist()))
        if not (self.density_kg_m3 > 0 and self.fluid_density_kg_m3 > 0):
            raise InputError(
                "density_kg_m3 and fluid_density_kg_m3 must be > 0 "
                f"(got {self.density_kg_m3}, {self.fluid_density_kg_m3})"
            )
        if self.fluid_level_mm is not None and not np.isfinite(self.fluid_level_mm):
            raise InputError(
                f"fluid_level_mm must be finite or None (got {self.fluid_level_mm})"
            )

    def check_against(self, mesh: TetMesh) -> None:
        """Any mesh has weight."""

    def bind(self, mesh: TetMesh) -> Callable[[FloatArray, float], FloatArray]:
        """Return force(u, load factor), (n_points, 3), N."""
        down = np.array(self.direction)
        weight = 1e-9 * STANDARD_GRAVITY * self.density_kg_m3 * mesh.cell_volumes
        lift = 1e-9 * STANDARD_GRAVITY * self.fluid_density_kg_m3

        def force(u: FloatArray, load_factor: float) -> FloatArray:
            pull = weight
            if self.fluid_level_mm is not None:
                x = mesh.points + u
                depth = self.fluid_level_mm + x @ down
                pull = weight - lift * submerged_volumes(x, mesh.cells, depth)
            at_corner = np.repeat(pull / 4 * load_factor, 4)
            on_points = np.bincount(
                mesh.cells.ravel(), weights=at_corner, minlength=mesh.n_points
            )
            total: FloatArray = on_points[:, None] * down
            return total

        return force


@njit(cache=True)
def submerged_volumes(points, cells, depth):  # type: ignore[no-untyped-def]
    """Volume of every cell's part where a depth, linear in it, is positive.

    Parameters
    ----------
    points : (n_points, 3) array
    cells : (n_cells, 4) integer array
    depth : (n_points,) array
        Of every point, negative above the surface.

    Returns
    -------
    (n_cells,) array
    """
    volumes = np.empty(len(cells))
    for e in range(len(cells)):
        lowest, highest = np.inf, -np.inf
        for i in range(4):
            lowest = min(lowest, depth[cells[e, i]])
            highest = max(highest, depth[cells[e, i]])
        if highest <= 0.0:
            volumes[e] = 0.0
            continue
        a = points[cells[e, 0]]
        p, q, r = (
            points[cells[e, 1]] - a,
            points[cells[e, 2]] - a,
            points[cells[e, 3]] - a,
        )
        volume = (
            p[0] * (q[1] * r[2] - q[2] * r[1])
            + p[1] * (q[2] * r[0] - q[0] * r[2])
            + p[2] * (q[0] * r[1] - q[1] * r[0])
        ) / 6
        volumes[e] = volume
        if lowest < 0.0:  # few are cut, and sorting takes longer than all else
            volumes[e] *= _submerged_fraction(np.sort(depth[cells[e]]))
    return volumes


@njit(cache=True)
def _submerged_fraction(depth):  # type: ignore[no-untyped-def]
    """Fraction of a tetrahedron, which the surface cuts, below it; depths ascending."""
    a, b, c, d = depth
    if c <= 0:  # one corner under water: a small tetrahedron
        return d**3 / ((d - a) * (d - b) * (d - c))
    if b >= 0:  # one corner above: all but a small tetrahedron
        return 1 + a**3 / ((b - a) * (c - a) * (d - a))
    # Two and two: a wedge of three tetrahedra, cut where edges cross the surface.
    ca, cb = c / (c - a), c / (c - b)
    da, db = d / (d - a), d / (d - b)
    return da * db + db * ca * (1 - da) + (1 - db) * ca * cb
