"""The policy of repairs: how far a displacement is trusted, and what follows if not.

Everything that decides on a repair stands here: how much an estimate of the error is
enlarged, what is good enough, what a repair begins at, and what its outcome is called.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.learning.graph import graph_of
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.relaxation import Relaxation
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.warm_start import WarmStartSolver
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.submodels.near_loads import FEW
from physgnn.prediction.prediction import ErrorBound, LikelyError, PredictionStatus

WRONG_BY = 2.0  # the physical estimate may be too small by such a factor
UNSURE_BY = 4.0  # it is made so much larger beyond UNSURE_FROM
UNSURE_FROM = 1.5  # edges deep
SAFETY = 10.0  # the solver's own estimate must be so much below the tolerance
DEEPEST = 1.2  # edges, of a displacement that a repair begins at
AIM = 0.8  # of that, where a smaller fraction of the load is looked for
MAX_TRIES = 4
STATUS_BY_ORIGIN = {
    "guess": PredictionStatus.REPAIRED,
    "path": PredictionStatus.SOLVED,
}


@dataclass(frozen=True, eq=False)
class Start:
    """What a repair begins at.

    Attributes
    ----------
    displacement : (n_points, 3) array or None
        Where to begin, mm; None for rest.
    load_fraction : float
        The fraction of the load that it belongs to.
    """

    displacement: FloatArray | None
    load_fraction: float


def depth(body: Body, case: LoadCase, displacement: FloatArray) -> float:
    """Return how many mean edges a force on few points pushes them in.

    Cells under such a force snap through when it pushes them in deep, and then other
    equilibria lie near; the one meant is that which the growing load reaches. Where an
    displacement is not deep it tells which one that is: the repairs seen that began at
    one and ended at another equilibrium began 1.42 edges deep or more
    (docs/results/repair.md). Zero if the load acts on many points.

    Parameters
    ----------
    body : Body
    case : LoadCase
    displacement : (n_points, 3) array
        Its displacement, mm.
    """
    loaded = case.nodes[case.forces.any(axis=1)]
    if len(loaded) > FEW:
        return 0.0
    graph = graph_of(body)
    rows = zip(graph.row_start[loaded], graph.row_start[loaded + 1], strict=True)
    edges = np.array([float((1 / graph.weight[a:b]).mean()) for a, b in rows])
    way = np.linalg.norm(displacement[loaded], axis=1)
    return float((way / edges).max(initial=0.0))


def cautious_error(body: Body, case: LoadCase, relaxed: Relaxation) -> FloatArray:
    """Return the physical estimate of the error, (n_points, 3), mm.

    Relaxation measures the distance to the nearest equilibrium. Where others lie near,
    that may not be the one meant, so the estimate grows by `UNSURE_BY`.
    """
    sure = depth(body, case, relaxed.displacement) <= UNSURE_FROM
    return relaxed.error if sure else UNSURE_BY * relaxed.error


def where_to_begin(
    predict: Callable[[LoadCase], FloatArray] | None,
    body: Body,
    case: LoadCase,
    displacement: FloatArray,
) -> Start:
    """Return the displacement under a load, or a fraction of it that tells its state.

    Parameters
    ----------
    predict : callable or None
        Is asked for smaller loads; None if it is not to be trusted, and then the
        repair begins at rest.
    body : Body
    case : LoadCase
    displacement : (n_points, 3) array
        Under the whole load, mm.
    """
    if predict is None:
        return Start(None, 0.0)
    fraction = 1.0
    for _ in range(MAX_TRIES):
        part = LoadCase(case.nodes, fraction * case.forces)
        if fraction < 1.0:
            displacement = predict(part)
        deep = depth(body, part, displacement)
        if deep <= DEEPEST:
            return Start(displacement, fraction)
        if not np.isfinite(deep):
            break
        fraction *= AIM * DEEPEST / deep
    return Start(None, 0.0)


def good_enough(
    bounds: ErrorBound | None, likely: LikelyError, tolerance_mm: float
) -> bool:
    """Whether an error may be taken to be below a tolerance."""
    if bounds is None:
        return False
    return max(bounds.max_mm, WRONG_BY * likely.max_mm) <= tolerance_mm


def repair(
    solver: WarmStartSolver, case: LoadCase, start: Start, tolerance_mm: float
) -> tuple[FloatArray, ErrorBound | None, PredictionStatus]:
    """Return the stable equilibrium next to a start, its error and its status.

    What the start lacks of the load is followed from there; without an equilibrium next
    to it, the whole load is. Where none is found the error is None and the status
    TOLERANCE_NOT_MET.
    """
    within = tolerance_mm / SAFETY
    found = solver.solve(
        case,
        start.displacement,
        load_fraction=start.load_fraction,
        tolerance_mm=within,
    )
    if found.status != Status.CONVERGED:
        return found.displacement, None, PredictionStatus.TOLERANCE_NOT_MET
    error = ErrorBound(within, within, 1.0)
    return found.displacement, error, STATUS_BY_ORIGIN[found.origin]
