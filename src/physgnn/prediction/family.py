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
from physgnn.prediction.calibration import (
    COVERAGES,
    Calibration,
    bounds,
    error_scores,
)
from physgnn.prediction.indicators import INDICATORS
from physgnn.prediction.network import network_answer, quick_linear
from physgnn.prediction.predictor import CALIBRATION_FILE
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
    """Calibrate a run on its validation patients and store the result there.

    What is exchangeable with a new patient are patients, not load paths: of n held-out
    ones no bound can promise more than n / (n + 1).

    Parameters
    ----------
    run : path
        Folder of a network trained on several bodies.
    stores, splits : sequences of Store and Split
        What it was trained on.
    indicator : str
        Row of `indicators.INDICATORS`.
    coverages : sequence of float
        Wanted coverage of the error bounds, that of every prediction first.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Raises
    ------
    InputError
        If the network belongs to its body.
    """
    trained = Checkpoint.load(run)
    scores, patients = [], []
    held_out = [
        pair for pair in zip(stores, splits, strict=True) if len(pair[1].validation)
    ]
    for number, (store, split) in enumerate(held_out):
        samples = split.validation
        model = adapt(trained, Body.of(store), sample_forces(store, samples)).model
        measure = INDICATORS[indicator](model.body, quick_linear(model))
        scores.append(
            error_scores(
                network_answer(model), measure, store, samples, progress=progress
            )
        )
        patients.append(np.full(len(samples), number))
    score, patient = np.concatenate(scores), np.concatenate(patients)
    rows = [bounds(score, patient, coverage) for coverage in coverages]
    coverage, mean_factor, max_factor = rows[0]
    calibration = Calibration(
        indicator=indicator,
        coverage=coverage,
        mean_factor=mean_factor,
        max_factor=max_factor,
        n_paths=len(held_out),
        n_samples=len(score),
        trained_range=_range_of(stores, splits),
        others=tuple(rows[1:]),
    )
    calibration.write(Path(run) / CALIBRATION_FILE)
    return calibration


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
