"""Run predictors over samples and gather their errors."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.choices import Estimate
from physgnn.evaluation.measure.cached_rows import CachedRows
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.metrics import (
    PooledErrors,
    SampleError,
    nodal_errors,
    points_near,
    points_of_region,
    summarise_samples,
)
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.measure.rows import Row
from physgnn.geometry.regions import TUMOUR
from physgnn.geometry.tetmesh import TetMesh
from physgnn.prediction.prediction import Prediction
from physgnn.progress import Progress


def evaluate(
    rows: Sequence[Row],
    held_out: HeldOut,
    *,
    cached: CachedRows | None = None,
    facts: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Return the errors of every row's predictor on the same samples.

    One predictor is made, measured and dropped before the next is made.

    Parameters
    ----------
    rows : sequence of Row
        In the order of presentation.
    held_out : HeldOut
        What to test on.
    cached : CachedRows, optional
        Rows measured earlier are taken from there, and new ones put there.
    facts : mapping, optional
        Provenance to carry into the report; JSON values.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Returns
    -------
    Report
        Errors of each row, mm, and its seconds.
    """
    measured = []
    for i, row in enumerate(rows):
        errors = cached.get(row) if cached else None
        if errors is None:
            move = progress and _part(progress, i, len(rows), row.name)
            errors = measure(row, held_out, progress=move)
            if cached:
                cached.put(row, errors)
        measured.append(errors)
    return Report(
        split=held_out.split,
        load_factors=tuple(float(factor) for factor in held_out.store.load_factors),
        models=tuple(measured),
        facts=dict(facts or {}),
    )


def measure(
    row: Row, held_out: HeldOut, *, progress: Progress | None = None
) -> ModelErrors:
    """Make one row's predictor and return its errors.

    Training that happens here is timed in processor minutes, of all threads.
    """
    start = time.process_time()
    predict = row.make()
    minutes = (time.process_time() - start) / 60 if row.minutes is None else row.minutes
    store, samples = held_out.store, held_out.test
    near = lru_cache(maxsize=1)(
        lambda path: points_near(store.mesh, store.load_path(path).nodes)
    )
    gatherer = ErrorGatherer(row.name, store.mesh, store.load_factors)
    order = np.lexsort((samples[:, 1], samples[:, 0]))  # one read a path
    for done, (path, level) in enumerate(samples[order].tolist()):
        prediction = predict(
            row.case(store, path, level),
            tolerance_mm=row.tolerance_mm,
            estimate=Estimate.QUICK,
        )
        truth = store.displacement(path)[level].astype(np.float64)
        gatherer.add((path, level), truth, prediction, near(path))
        if progress is not None:
            progress(done + 1, len(samples), "evaluating")
    return replace(
        gatherer.result(),
        seed=row.seed,
        minutes=minutes,
        tolerance_mm=row.tolerance_mm,
    )


def _part(progress: Progress, index: int, n_parts: int, name: str) -> Progress:
    """Return the progress of one of several rows as a part of the whole."""
    return lambda done, total, _: progress(index * total + done, n_parts * total, name)


class ErrorGatherer:
    """Collects the errors of one predictor.

    Parameters
    ----------
    name : str
        Of the predictor.
    mesh : TetMesh
        On whose points displacements are compared.
    load_factors : (n_levels,) array
        Of every level that a sample may have.
    """

    def __init__(self, name: str, mesh: TetMesh, load_factors: FloatArray) -> None:
        self._name = name
        self._load_factors = load_factors
        self._pooled = PooledErrors(len(load_factors))
        self._samples: list[SampleError] = []
        tumour = points_of_region(mesh, TUMOUR)
        self._tumour = tumour if tumour.any() else None

    def add(
        self,
        sample: tuple[int, int],
        truth: FloatArray,
        prediction: Prediction,
        near: BoolArray,
    ) -> None:
        """Take one prediction in.

        Parameters
        ----------
        sample : (path, level)
            Which it is.
        truth : (n_points, 3) array
            mm.
        prediction : Prediction
            Of the same.
        near : (n_points,) boolean array
            The loaded region.
        """
        path, level = sample
        errors = nodal_errors(truth, prediction.displacement)
        regions = {"loaded_region": near}
        if self._tumour is not None:
            regions["tumour"] = self._tumour
        self._pooled.add(errors, level, regions)
        distance, size = errors["euclidean"], np.linalg.norm(truth, axis=1)
        means = {name: float(distance[mask].mean()) for name, mask in regions.items()}
        estimate = prediction.error_estimate_mm
        self._samples.append(
            SampleError(
                path=path,
                level=level,
                load_factor=float(self._load_factors[level]),
                mean=float(distance.mean()),
                largest=float(distance.max()),
                relative=float(np.linalg.norm(distance) / np.linalg.norm(size)),
                mean_displacement=float(size.mean()),
                largest_displacement=float(size.max()),
                loaded_region=means["loaded_region"],
                tumour=means.get("tumour"),
                estimate_mean=estimate.mean_mm if estimate else None,
                estimate_largest=estimate.max_mm if estimate else None,
                status=prediction.status.name,
                seconds=prediction.seconds,
            )
        )

    def result(self) -> ModelErrors:
        """Return the errors of all that were taken in."""
        return ModelErrors(
            name=self._name,
            by_component=self._pooled.by_component(),
            by_region=self._pooled.by_region(),
            by_level=self._pooled.by_level(),
            histogram=self._pooled.components["euclidean"].histogram(),
            summary=summarise_samples(self._samples),
            samples=tuple(self._samples),
        )
