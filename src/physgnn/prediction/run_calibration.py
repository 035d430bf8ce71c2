"""The error bounds of a trained run, calibrated on what its training held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.learning.run_folder import RunFolder
from physgnn.prediction.calibration import (
    COVERAGES,
    RELAXATION,
    Calibration,
    calibrate,
    thinned,
)
from physgnn.prediction.indicators import INDICATORS, Indicator
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress


@dataclass(frozen=True)
class Kind:
    """One kind of bounds.

    Attributes
    ----------
    file : callable
        From a run folder to where it keeps its calibration.
    indicator : str
        What is scaled.
    measure : callable
        From a predictor to the indicator.
    most : int
        Samples to calibrate on, at most.
    """

    file: Callable[[RunFolder], Path]
    indicator: str
    measure: Callable[[Predictor], Indicator]
    most: int


def kinds_of_bounds(indicator: str) -> tuple[Kind, ...]:
    """Return the quick bounds, by a row of `INDICATORS`, and the sharper ones."""
    quick = INDICATORS[indicator]
    return (
        Kind(
            lambda run: run.calibration,
            indicator,
            lambda p: quick(p.body, p.linear),
            10_000,
        ),
        # A sample of these costs about ten of the quick ones, and what counts is how
        # many load paths they come from.
        Kind(lambda run: run.relaxation, RELAXATION, lambda p: p.error, 150),
    )


def calibrate_run(
    run: str | Path,
    store: Store,
    split: Split,
    *,
    indicator: str = "correction",
    coverages: Sequence[float] = COVERAGES,
    progress: Progress | None = None,
) -> Calibration:
    """Calibrate the model of a run on the validation set and store the results there.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    store, split : Store, Split
        What it was trained on.
    indicator : str
        Row of `indicators.INDICATORS`, for the quick bounds.
    coverages : sequence of float
        Wanted coverage of the error bounds, that of every prediction first.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Returns
    -------
    Calibration
        That of the quick bounds.
    """
    predictor = Predictor.load(run)
    made = []
    for kind in kinds_of_bounds(indicator):
        calibration = calibrate(
            predictor.answer,
            (kind.indicator, kind.measure(predictor)),
            store,
            (split.train, thinned(split.validation, kind.most)),
            coverages=coverages,
            progress=progress,
        )
        calibration.write(kind.file(RunFolder(Path(run))))
        made.append(calibration)
    return made[0]
