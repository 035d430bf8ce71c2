"""The cell volume that gives a wanted number of points, by runs of a mesher."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh

TARGET_RANGE = (1_000, 200_000)
TARGET_RUNS = 6
# Of the tolerance: larger cells change no more, the surfaces set the number.
SATURATED = 0.2
# Edges twice as long: fTetWild halves the edges of its first mesh until they are short
# enough, so the number of points runs in steps over the edge, and a mesh with edges
# twice as long is on the same step. It has as many points less on each of four pairs of
# meshes (of 3,000 to 40,000 points, the bundled brain) to within 8 %.
COARSER, FEWER = 8.0, 8.0**0.95
COARSE_FROM = 20_000  # points below which a run takes less than a minute
COARSE_TOLERANCE = 0.05

Mesh = Callable[[float], TetMesh]


@dataclass(frozen=True)
class Target:
    """What a search for a number of points is to reach, and where it begins.

    Parameters
    ----------
    n_points : int
        Wanted.
    first_volume_mm3 : float
        The cell volume of the first run.
    tolerance : float
        How far log(points) may be off.
    on_surfaces : int
        How many points lie on the surfaces whatever the cells are; 0 if it is not to
        be thought of.
    """

    n_points: int
    first_volume_mm3: float
    tolerance: float
    on_surfaces: int = 0

    def __post_init__(self) -> None:
        """Raise InputError if so many points are not to be had."""
        low, high = TARGET_RANGE
        if not low <= self.n_points <= high:
            raise InputError(
                f"target_points must be in {low}…{high} (got {self.n_points})"
            )


def mesh_near(target: Target, mesh: Mesh) -> TetMesh:
    """Return the mesh nearest to a number of points within a few runs.

    Raises
    ------
    InputError
        If a run fails.
    """
    return _search(target, mesh)[1]


def mesh_from_coarser(target: Target, mesh: Mesh) -> TetMesh:
    """Return the same, after a search among coarser meshes, which are made sooner.

    Raises
    ------
    InputError
        If a run fails.
    """
    fewer = round(target.n_points / FEWER)
    if target.n_points < COARSE_FROM or fewer < 2 * target.on_surfaces:
        return mesh_near(target, mesh)
    volume = COARSER * target.first_volume_mm3
    coarse = Target(fewer, volume, COARSE_TOLERANCE, target.on_surfaces)
    log_volume = _search(coarse, mesh)[0]
    first = float(np.exp(log_volume)) / COARSER
    return mesh_near(Target(target.n_points, first, target.tolerance), mesh)


def _search(target: Target, mesh: Mesh) -> tuple[float, TetMesh]:
    """Return the logarithm of the cell volume, and the mesh.

    Points inside grow as 1/volume, those on the surfaces stay; then secant steps on
    log(points) over log(volume). Where more lie on the surfaces than are wanted, the
    first run that says so is the last.
    """
    wanted, on_surfaces = target.n_points, target.on_surfaces
    log_volume = np.log(target.first_volume_mm3)
    tried: list[tuple[float, float, TetMesh]] = []
    for _ in range(TARGET_RUNS):
        found = mesh(float(np.exp(log_volume)))
        excess = float(np.log(found.n_points / wanted))
        tried.append((log_volume, excess, found))
        if abs(excess) < target.tolerance or (excess > 0.0 and wanted <= on_surfaces):
            break
        if len(tried) > 1:
            (x0, y0, _), (x1, y1, _) = tried[-2:]
            if abs(y1 - y0) < SATURATED * target.tolerance:
                break
            step = -excess / min((y1 - y0) / (x1 - x0), -0.1)
        elif min(found.n_points, wanted) > on_surfaces:
            step = np.log((found.n_points - on_surfaces) / (wanted - on_surfaces))
        else:
            step = excess
        log_volume += np.clip(step, -4.0, 4.0)
    log_volume, _, found = min(tried, key=lambda run: abs(run[1]))
    return float(log_volume), found
