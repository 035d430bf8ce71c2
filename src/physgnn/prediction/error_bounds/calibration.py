"""Error estimates that keep a promised coverage, calibrated on held-out samples."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.learning.runs.parts import check_part, write_part
from physgnn.learning.surrogate import Surrogate
from physgnn.prediction.error_bounds.conformal import conformal_quantile
from physgnn.prediction.error_bounds.indicators import Indicator
from physgnn.prediction.error_bounds.trained_range import TrainedRange
from physgnn.prediction.prediction import ErrorBound
from physgnn.progress import Progress

if TYPE_CHECKING:
    from physgnn.dataset.storage.store import Store

COVERAGES = (0.9, 0.95)
RELAXATION = "relaxation"  # the indicator of `physgnn.mechanics.equilibrium.relaxation`
FLOOR_MM = 0.01  # added to the indicator, so that tiny loads do not set the factor


@dataclass(frozen=True)
class Calibration:
    """Factors from indicator to error bound, and the loads they hold for.

    Attributes
    ----------
    indicator : str
        Row of `indicators.INDICATORS`, or `RELAXATION`.
    coverage : float
        Probability that a bound holds for a new load path.
    mean_factor, max_factor : float
        Bound on the mean (largest) error / (mean (largest) indicator + `FLOOR_MM`).
    n_paths, n_samples : int
        What it was calibrated on.
    trained_range : TrainedRange
        Loads of the training samples.
    others : tuple of (coverage, mean factor, max factor)
        Factors for other promises (`at`).
    """

    indicator: str
    coverage: float
    mean_factor: float
    max_factor: float
    n_paths: int
    n_samples: int
    trained_range: TrainedRange
    others: tuple[tuple[float, float, float], ...] = ()

    def __post_init__(self) -> None:
        """Refuse numbers that would make bounds which promise nothing."""
        for coverage, *factors in (
            (self.coverage, self.mean_factor, self.max_factor),
            *self.others,
        ):
            if not 0 < coverage < 1:
                raise InputError(f"coverage must be in (0, 1) (got {coverage})")
            if not all(np.isfinite(factor) and factor >= 0 for factor in factors):
                raise InputError(f"factors must be finite and ≥ 0 (got {factors})")

    def at(self, coverage: float) -> "Calibration":
        """Return the same with another promise; InputError names those there are."""
        rows = ((self.coverage, self.mean_factor, self.max_factor), *self.others)
        for promised, mean, largest in rows:
            if promised == coverage:
                return replace(
                    self, coverage=promised, mean_factor=mean, max_factor=largest
                )
        have = ", ".join(f"{row[0]:g}" for row in rows)
        raise InputError(f"no bounds are calibrated for coverage {coverage:g} ({have})")

    def estimate(self, field: FloatArray) -> ErrorBound:
        """Return the error bounds that follow from an indicator field."""
        mean, largest = indicator_sizes(field)
        return ErrorBound(
            mean_mm=self.mean_factor * mean,
            max_mm=self.max_factor * largest,
            coverage=self.coverage,
        )

    def write(self, path: Path) -> None:
        """Write as JSON into a run folder, whole or not at all, and list it there."""
        write_part(path, json.dumps(asdict(self), indent=1, allow_nan=False))

    @classmethod
    def read(cls, path: Path) -> "Calibration":
        """Read what `write` wrote.

        Raises
        ------
        InputError
            If it is something else, was changed, or belongs to another run.
        """
        try:
            record = json.loads(path.read_text("utf-8"))
            loads = TrainedRange.from_json(record.pop("trained_range"))
            others = tuple(map(tuple, record.pop("others", ())))
            made = cls(**record, trained_range=loads, others=others)
        except (
            InputError,
            OSError,
            ValueError,
            KeyError,
            TypeError,
            AttributeError,
        ) as error:
            raise InputError(
                f"{path} is not a calibration ({error}): calibrate the run again"
            ) from error
        check_part(path)
        return made


def indicator_sizes(field: FloatArray) -> tuple[float, float]:
    """Return mean and largest length of an indicator field, floor included, mm."""
    length = np.linalg.norm(field, axis=-1)
    return float(length.mean()) + FLOOR_MM, float(length.max()) + FLOOR_MM


def calibrate(
    surrogate: Surrogate,
    indicator: tuple[str, Indicator],
    store: "Store",
    samples: tuple[IntArray, IntArray],
    *,
    coverages: Sequence[float] = COVERAGES,
    progress: Progress | None = None,
) -> Calibration:
    """Return the factors that cover the errors of samples the model was not fitted to.

    Parameters
    ----------
    surrogate : Surrogate
        Gives the displacements that the bounds are of.
    indicator : (str, callable)
        Name and function of the indicator.
    store : Store
        Holds the true displacements.
    samples : two (n, 2) integer arrays
        Training samples, for the range of loads, and calibration samples, which must
        be held out from training (the validation set; never the test set).
    coverages : sequence of float
        Wanted coverage, the one of every prediction first; what few load paths cannot
        promise is lowered (`conformal.conformal_quantile`).
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Raises
    ------
    InputError
        If there are no samples to calibrate on.
    """
    train, held_out = samples
    if len(train) == 0 or len(held_out) == 0:
        raise InputError(
            "calibration needs training and validation samples "
            f"(got {len(train)} and {len(held_out)}): simulate more load paths"
        )
    name, measure = indicator
    scores = error_scores(surrogate, measure, store, held_out, progress=progress)
    loads = TrainedRange.from_cases(
        store.load_case(path, level) for path, level in train.tolist()
    )
    return from_scores(name, scores, held_out[:, 0], loads, coverages)


def from_scores(
    indicator: str,
    scores: FloatArray,
    groups: IntArray,
    loads: TrainedRange,
    coverages: Sequence[float] = COVERAGES,
) -> Calibration:
    """Return the calibration that follows from true errors over indicators.

    Parameters
    ----------
    indicator : str
        Its name.
    scores : (n, 2) array
        True error / indicator of the samples, mean and largest.
    groups : (n,) integer array
        What is exchangeable with what is to come: the load path or patient of each.
    loads : TrainedRange
        Where the bounds hold.
    coverages : sequence of float
        See `calibrate`.
    """
    rows = [_bounds(scores, groups, coverage) for coverage in coverages]
    coverage, mean_factor, max_factor = rows[0]
    return Calibration(
        indicator=indicator,
        coverage=coverage,
        mean_factor=mean_factor,
        max_factor=max_factor,
        n_paths=len(np.unique(groups)),
        n_samples=len(scores),
        trained_range=loads,
        others=tuple(rows[1:]),
    )


def _bounds(
    scores: FloatArray, groups: IntArray, coverage: float
) -> tuple[float, float, float]:
    """Return the coverage reached and the factors of mean and largest error."""
    mean_factor, reached = conformal_quantile(scores[:, 0], groups, coverage)
    max_factor, _ = conformal_quantile(scores[:, 1], groups, coverage)
    return reached, mean_factor, max_factor


def thinned(samples: IntArray, most: int) -> IntArray:
    """Return every so many of the samples, the last of each stretch: at most `most`."""
    every = max(-(-len(samples) // most), 1)
    return samples[every - 1 :: every]


def error_scores(
    surrogate: Surrogate,
    measure: Indicator,
    store: "Store",
    samples: IntArray,
    *,
    progress: Progress | None = None,
) -> FloatArray:
    """Return true error over indicator of samples, mean and largest, (n, 2)."""
    scores = np.empty((len(samples), 2))
    for i, (path, level) in enumerate(samples.tolist()):
        case = store.load_case(path, level)
        predicted = surrogate.predict(case)
        error = np.linalg.norm(store.displacement(path)[level] - predicted, axis=1)
        mean, largest = indicator_sizes(measure(case, predicted))
        scores[i] = error.mean() / mean, error.max() / largest
        if progress is not None:
            progress(i + 1, len(samples), "calibrating")
    return scores
