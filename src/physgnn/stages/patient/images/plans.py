"""From a plan and a displacement to the plan where the brain is now."""

from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.no_tissue import points_within
from physgnn.imaging.point_displacement import PointDisplacement, displacement_at
from physgnn.imaging.reversal import reverse
from physgnn.imaging.scattered_fields import interpolated
from physgnn.io.plans.formats import plan_named_like, read_plan, write_plan
from physgnn.io.plans.plan import Plan
from physgnn.io.vtk.error_fields import DEVIATION, read_error_fields
from physgnn.io.vtk.prediction_file import read_displacement, read_removed
from physgnn.io.vtk.reader import read_vtk
from physgnn.progress import Log, no_log

MOST_NAMES = 20  # of points, in one line


def warp_plan(
    path: str | Path,
    prediction: str | Path,
    out: str | Path,
    *,
    back: bool = False,
    log: Log = no_log,
) -> Plan:
    """Move the points of a plan as a prediction says; see `physgnn.stages.warp`.

    Parameters
    ----------
    path : path
        Points, curves, a model or tracts: see `physgnn.io.plans.formats`.
    prediction : path
        VTU with the point array ``displacement_mm``.
    out : path
        In the plan's own format.
    back : bool
        The plan is of the deformed state, and goes back to the rest state.
    log : callable
        Gets a line on how far points move, on those outside of the brain, on how
        uncertain that is at points with names, and on how far tissue between points of
        a curve leaves the straight line.

    Raises
    ------
    InputError
        If a file cannot be used, or plan and mesh do not meet.
    """
    out = plan_named_like(out, path)
    plan = read_plan(path)
    mesh, u = read_displacement(prediction, log=log)
    if back:
        mesh, u = reverse(mesh, u)
    # the middles of links are carried along to see how far tissue bends there
    middles = plan.points[plan.links].mean(axis=1)
    removed = read_removed(prediction)
    try:
        found = displacement_at(mesh, u, np.concatenate([plan.points, middles]))
    except InputError as error:
        gone = removed is not None and not back and points_within(removed, plan.points)
        if np.all(gone):
            raise InputError(
                f"{path}: a plan must have a place in the brain now (this is "
                f"{_points(len(plan.points))}, all in tissue that was removed): give "
                "another plan"
            ) from error
        raise InputError(f"{path}: {error}") from error
    n = len(plan.points)
    moved = plan.moved_to(plan.points + found.vectors[:n])
    lines = [_moved(found.vectors[:n]), *_outside(plan, found)]
    at_rest = moved.points if back else plan.points
    lines += _gone(plan, at_rest, found, removed)
    if plan.labels and n <= MOST_NAMES and not back:
        lines += _trust(prediction, plan)
    if len(middles):
        straight = moved.points[plan.links].mean(axis=1)
        lines.append(_bent(middles + found.vectors[n:], straight))
    write_plan(out, moved)
    for line in lines:
        log(line)
    return moved


def _moved(vectors: FloatArray) -> str:
    lengths = np.linalg.norm(vectors, axis=1)
    return (
        f"{_points(len(vectors))} moved by {lengths.mean():.2f} mm on average, "
        f"{lengths.max():.2f} mm at most"
    )


def _outside(plan: Plan, found: PointDisplacement) -> list[str]:
    """Say which points are not in the brain, and what became of them."""
    away = found.outside_mm[: len(plan.points)]
    kinds = {
        "moved as the brain's surface nearby, less with distance": (
            (away > 0) & (away < found.fade_mm)
        ),
        f"{found.fade_mm:.0f} mm or more away, not moved": away >= found.fade_mm,
    }
    return [
        f"warning: outside of the brain, {what}: {_named(plan, away, which)}"
        for what, chosen in kinds.items()
        if len(which := np.flatnonzero(chosen))
    ]


def _gone(
    plan: Plan, at_rest: FloatArray, found: PointDisplacement, removed: TetMesh | None
) -> list[str]:
    """Say which points are in tissue that was removed, and so nowhere."""
    if removed is None:
        return []
    inside = points_within(removed, at_rest)
    away = found.outside_mm[: len(at_rest)]
    which = np.flatnonzero(inside & (away > 0))
    if not len(which):
        return []
    return [
        "warning: in tissue that was removed, with no place in the brain now: "
        f"{_named(plan, away, which)}"
    ]


def _points(n: int) -> str:
    return "1 point" if n == 1 else f"{n} points"


def _named(plan: Plan, away: FloatArray, which: IntArray) -> str:
    """Name points with their distance; of many, how many and how far at most."""
    if not plan.labels or len(which) > MOST_NAMES:
        most = float(away[which].max())
        return f"{len(which)} of {len(away)} points, by up to {most:.1f} mm"
    return ", ".join(f"{plan.name(int(i))} ({away[i]:.1f} mm)" for i in which)


def _trust(prediction: str | Path, plan: Plan) -> list[str]:
    """Say how uncertain the displacement is at named points, where the file says so."""
    arrays = read_vtk(Path(prediction)).point_data
    if DEVIATION not in arrays:
        return []
    fields = read_error_fields(prediction)
    deviation, inside = interpolated(
        fields.mesh, fields.deviation_mm[:, None], plan.points
    )
    known = [
        f"{plan.name(int(i))} {deviation[i, 0]:.1f} mm" for i in np.flatnonzero(inside)
    ]
    return [f"standard deviation in the brain: {', '.join(known)}"] if known else []


def _bent(tissue: FloatArray, straight: FloatArray) -> str:
    most = float(np.linalg.norm(tissue - straight, axis=1).max())
    return (
        f"halfway between its points, what lay on the curve lies up to {most:.2f} mm "
        "beside it"
    )
