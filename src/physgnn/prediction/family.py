"""Error bounds for a patient never seen, from patients held out of the training."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.learning.adaptation import adapt
from physgnn.learning.anchors import sample_forces
from physgnn.learning.checkpoint import Checkpoint
from physgnn.learning.interface import Body
from physgnn.learning.run_folder import RunFolder
from physgnn.prediction.calibration import (
    COVERAGES,
    Calibration,
    FloatArray,
    error_scores,
    from_scores,
    thinned,
)
from physgnn.prediction.predictor import Predictor
from physgnn.prediction.run_calibration import kinds_of_bounds
from physgnn.prediction.trained_range import TrainedRange
from physgnn.progress import Progress


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
                    predictor.answer,
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
    """Return the predictor for a held-out patient, who gives loads but no answers."""
    forces = sample_forces(store, split.validation)
    return Predictor.of(adapt(trained, Body.of(store), forces).model)


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
