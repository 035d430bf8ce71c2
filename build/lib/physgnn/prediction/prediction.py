"""What every predictor gives back: a displacement and how far to trust it."""

from dataclasses import dataclass
from typing import Protocol

from physgnn.arrays import FloatArray
from physgnn.choices import Estimate
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.prediction.status import PredictionStatus

__all__ = ["ErrorBound", "LikelyError", "Predict", "Prediction", "PredictionStatus"]


@dataclass(frozen=True)
class ErrorBound:
    """Bounds on the error of one prediction, each kept with probability `coverage`.

    Attributes
    ----------
    mean_mm, max_mm : float
        Bound on the mean and on the largest nodal Euclidean error, mm.
    coverage : float
        Fraction of unseen load cases whose error lies below the bound.
    """

    mean_mm: float
    max_mm: float
    coverage: float


@dataclass(frozen=True)
class LikelyError:
    """How large the error of one prediction seems, from a few steps of the solver.

    Attributes
    ----------
    mean_mm, max_mm : float
        Mean and largest nodal Euclidean error, mm; docs/results/error_bounds.md says
        how near.
    """

    mean_mm: float
    max_mm: float


@dataclass(frozen=True, eq=False)
class Prediction:
    """The displacement under one load case.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm, world axes.
    error_estimate_mm : ErrorBound or None
        None where the predictor has not been calibrated.
    status : PredictionStatus
        Its `remedy` says what to do.
    seconds : float
        Wall-clock time it took, the estimate included.
    likely_error_mm : LikelyError or None
        None if only the quick bounds were asked for.
    reasons : tuple of str
        Why it is not called ok, one line each.
    """

    displacement: FloatArray
    error_estimate_mm: ErrorBound | None
    status: PredictionStatus
    seconds: float
    likely_error_mm: LikelyError | None = None
    reasons: tuple[str, ...] = ()


class Predict(Protocol):
    """What turns a load case into a prediction: a `Predictor`, a solver."""

    def __call__(
        self,
        load_case: LoadCase,
        *,
        tolerance_mm: float | None = None,
        estimate: str = Estimate.PHYSICAL,
    ) -> Prediction:
        """Return the displacement under `load_case`; see `Predictor`."""
        ...
