"""When an answer is good enough, and how one that is not is taken to equilibrium."""

import numpy as np

from physgnn.learning.interface import Body
from physgnn.learning.near_loads import FEW
from physgnn.mechanics.approach import Approach
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.solution import Status
from physgnn.prediction.prediction import (
    ErrorEstimate,
    FloatArray,
    LikelyError,
    PredictionStatus,
)

WRONG_BY = 2.0  # the physical estimate may be too small by such a factor
SAFETY = 10.0  # the solver's own estimate must be so much below the tolerance
FARTHEST_IN = 1.5  # mean edges, of a point that one of few forces acts on
STATUS_BY_ORIGIN = {
    "guess": PredictionStatus.REPAIRED,
    "path": PredictionStatus.SOLVED,
}


def chooses_a_state(body: Body, case: LoadCase, displacement: FloatArray) -> bool:
    """Return whether an answer tells which of a load's equilibria is meant.

    Cells under a force on few points snap through when it pushes them in far, and then
    other equilibria lie near; the one meant is that which the growing load reaches. On
    dataset 1, all repairs seen that began at an answer and ended at another equilibrium
    had a loaded point 1.72 mean edges or more from where it was (docs/error_bars.md);
    a third of all samples have one more than 1.5 away.

    Parameters
    ----------
    body : Body
    case : LoadCase
    displacement : (n_points, 3) array
        The answer, mm.
    """
    loaded = case.nodes[case.forces.any(axis=1)]
    if len(loaded) > FEW:
        return True
    graph = body.graph
    rows = zip(graph.row_start[loaded], graph.row_start[loaded + 1], strict=True)
    edges = np.array([float((1 / graph.weight[a:b]).mean()) for a, b in rows])
    way = np.linalg.norm(displacement[loaded], axis=1)
    return bool((way <= FARTHEST_IN * edges).all())


def good_enough(
    bounds: ErrorEstimate | None, likely: LikelyError, tolerance_mm: float
) -> bool:
    """Whether an error may be taken to be below a tolerance."""
    if bounds is None:
        return False
    return max(bounds.max_mm, WRONG_BY * likely.max_mm) <= tolerance_mm


def repair(
    approach: Approach, case: LoadCase, guess: FloatArray | None, tolerance_mm: float
) -> tuple[FloatArray, ErrorEstimate | None, PredictionStatus]:
    """Return the stable equilibrium next to a guess, its error and its status.

    Without a guess, or without an equilibrium next to it, the load is followed from
    rest. Where none is found the error is None and the status TOLERANCE_NOT_MET.
    """
    within = tolerance_mm / SAFETY
    found = approach.solve(case, guess, tolerance_mm=within)
    if found.status != Status.CONVERGED:
        return found.displacement, None, PredictionStatus.TOLERANCE_NOT_MET
    error = ErrorEstimate(within, within, 1.0)
    return found.displacement, error, STATUS_BY_ORIGIN[found.origin]
