"""When an answer is good enough, and how one that is not is taken to equilibrium."""

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
STATUS_BY_ORIGIN = {
    "guess": PredictionStatus.REPAIRED,
    "path": PredictionStatus.SOLVED,
}


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
