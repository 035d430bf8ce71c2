"""The error bounds of a trained run, calibrated on what its training held out.

A run trained on one mesh holds out load paths, one trained on several holds out
patients: what is exchangeable with what is to come differs, the rest is the same.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.dataset.training_loads import strongest_forces
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.prediction.error_bounds.calibration import (
    COVERAGES,
    RELAXATION,
    Calibration,
    calibrate,
    error_scores,
    from_scores,
    thinned,
)
from physgnn.prediction.error_bounds.indicators import INDICATORS, Indicator
from physgnn.prediction.error_bounds.trained_range import TrainedRange
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
            lambda p: quick(p.surrogate),
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
            predictor.surrogate,
            (kind.indicator, kind.measure(predictor)),
            store,
            (split.train, thinned(split.validation, kind.most)),
            coverages=coverages,
            progress=progress,
        )
        calibration.write(kind.file(RunFolder(Path(run))))
        made.append(calibration)
    return made[0]


def calibrate_family(
    run: str | Path,
    stores: Sequence[Store],
    splits: Sequence[Split],
    *,
    indicator: str = "correction",
    coverages: Sequence[float] = COVERAGES,
    progress: Progress | None = None,
) -> Calibration:
    """Calibrate a run on its validation patients and store the results there.

    What is exchangeable with a new patient are patients, not load paths: of n held-out
    ones no bound can promise more than n / (n + 1).

    Parameters
    ----------
    run : path
        Folder of a network trained on several bodies.
    stores, splits : sequences of Store and Split
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

    Raises
    ------
    InputError
        If the network belongs to its body.
    """
    trained, kinds = Checkpoint.load(run), kinds_of_bounds(indicator)
    pairs = zip(stores, splits, strict=True)
    held_out = [pair for pair in pairs if len(pair[1].validation)]
    scores: list[list[FloatArray]] = [[] for _ in kinds]
    for store, split in held_out:
        predictor = _adapted(trained, store, split)
        for kind, found in zip(kinds, scores, strict=True):
            most = max(kind.most // len(held_out), 1)
            found.append(
                error_scores(
                    predictor.surrogate,
                    kind.measure(predictor),
                    store,
                    thinned(split.validation, most),
                    progress=progress,
                )
            )
    loads, made = _range_of(stores, splits), []
    for kind, found in zip(kinds, scores, strict=True):
        patients = np.repeat(np.arange(len(found)), [len(score) for score in found])
        calibration = from_scores(
            kind.indicator, np.concatenate(found), patients, loads, coverages
        )
        calibration.write(kind.file(RunFolder(Path(run))))
        made.append(calibration)
    return made[0]


def _adapted(trained: Checkpoint, store: Store, split: Split) -> Predictor:
    """Return the predictor for a held-out patient, who gives loads and no solutions."""
    forces = strongest_forces(store, split.validation)
    return Predictor(adapt(trained, store.body, forces).model)


def on_new_loads(calibration: Calibration, loads: TrainedRange) -> Calibration:
    """Return a family's calibration for a body and the loads it's prepared for.

    The force in all may not exceed the strongest the family was trained on.
    """
    strongest = min(loads.total_force_n, calibration.trained_range.total_force_n)
    return replace(calibration, trained_range=replace(loads, total_force_n=strongest))


def _range_of(stores: Sequence[Store], splits: Sequence[Split]) -> TrainedRange:
    """Return the range of the first body's loads, with the strongest of all bodies."""
    ranges = [
        TrainedRange.from_cases(
            store.load_case(path, level) for path, level in split.train.tolist()
        )
        for store, split in zip(stores, splits, strict=True)
        if len(split.train)
    ]
    strongest = max(loads.total_force_n for loads in ranges)
    return replace(ranges[0], total_force_n=strongest)
