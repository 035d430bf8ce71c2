"""What every predictor gives back: a displacement and how far to trust it."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

from physgnn.arrays import FloatArray
from physgnn.choices import Estimate
from physgnn.mechanics.loads.paths import LoadCase


class PredictionStatus(IntEnum):
    """How a prediction ended. The text of each is its remedy."""

    OK = 0
    SOLVED = 1
    OUTSIDE_TRAINED_RANGE = 2
    TOLERANCE_NOT_MET = 3
    REPAIRED = 4

    @property
    def remedy(self) -> str:
        """One line: what happened and what to do."""
        return _REMEDY[self]

    @property
    def usable(self) -> bool:
        """Whether the answer may be used with its error estimate as it is."""
        return self in (
            PredictionStatus.OK,
            PredictionStatus.REPAIRED,
            PredictionStatus.SOLVED,
        )

    def __str__(self) -> str:
        return self.name.lower().replace("_", " ")


_REMEDY = {
    PredictionStatus.OK: "the prediction can be used with its error estimate",
    PredictionStatus.REPAIRED: (
        "the estimate was above the tolerance, so the prediction was taken to "
        "equilibrium: raise tolerance_mm to save its time"
    ),
    PredictionStatus.SOLVED: (
        "the load was solved by finite elements from rest, no prediction being near "
        "enough: raise tolerance_mm to save its time"
    ),
    PredictionStatus.OUTSIDE_TRAINED_RANGE: (
        "the load lies outside the trained range, where the error estimate promises "
        "nothing: give tolerance_mm to have it solved"
    ),
    PredictionStatus.TOLERANCE_NOT_MET: (
        "the finite-element solve did not reach this load: lower the force or refine "
        "the mesh under it"
    ),
}


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
    """The answer to one load case.

    Attributes
    ----------
    displacement : (n_points, 3) array
        mm, world axes.
    error_estimate_mm : ErrorBound or None
        None where the predictor has not been calibrated.
    status : PredictionStatus
        Its `remedy` says what to do.
    seconds : float
        Wall-clock time of the answer, the estimate included.
    likely_error_mm : LikelyError or None
        None if only the quick bounds were asked for.
    """

    displacement: FloatArray
    error_estimate_mm: ErrorBound | None
    status: PredictionStatus
    seconds: float
    likely_error_mm: LikelyError | None = None


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
