"""Run predictors over samples and gather their errors."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.metrics import (
    BoolArray,
    FloatArray,
    PooledErrors,
    SampleError,
    nodal_errors,
    points_near,
    points_of_region,
    summarise_samples,
)
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.prediction.prediction import Predict, Prediction
from physgnn.progress import Progress

TUMOUR = 1  # region label


def evaluate(
    predictors: Mapping[str, Predict],
    store: Store,
    samples: NDArray[np.int64],
    *,
    split: str = "",
    facts: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Return the errors of every predictor on the same samples.

    Parameters
    ----------
    predictors : mapping of str to callables
        Each takes a LoadCase and returns a Prediction.
    store : Store
        Holds the true displacements.
    samples : (n, 2) integer array
        Rows of (path, level), converged ones only.
    split : str
        Name of the split they come from, for the report.
    facts : mapping, optional
        Provenance to carry into the report; JSON values.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Raises
    ------
    InputError
        If there are no samples.
    """
    if len(samples) == 0:
        raise InputError(
            f"split '{split}' has no samples to evaluate: simulate more load paths"
        )
    gatherers = {name: _Gatherer(name, store) for name in predictors}
    order = np.lexsort((samples[:, 1], samples[:, 0]))  # one read a path
    for done, (path, level) in enumerate(samples[order].tolist()):
        case = store.load_case(path, level)
        truth = store.displacement(path)[level].astype(np.float64)
        for name, predict in predictors.items():
            gatherers[name].add(path, level, truth, predict(case))
        if progress is not None:
            progress(done + 1, len(samples), "evaluating")
    return Report(
        split=split,
        load_factors=tuple(float(factor) for factor in store.load_factors),
        models=tuple(gatherer.result() for gatherer in gatherers.values()),
        facts=dict(facts or {}),
    )


class _Gatherer:
    """Collects the errors of one predictor."""

    def __init__(self, name: str, store: Store) -> None:
        self._name = name
        self._store = store
        self._pooled = PooledErrors(store.n_levels)
        self._samples: list[SampleError] = []
        tumour = points_of_region(store.mesh, TUMOUR)
        self._tumour = tumour if tumour.any() else None
        self._near = lru_cache(maxsize=1)(self._near_path)

    def _near_path(self, path: int) -> BoolArray:
        return points_near(self._store.mesh, self._store.load_path(path).nodes)

    def add(
        self, path: int, level: int, truth: FloatArray, prediction: Prediction
    ) -> None:
        errors = nodal_errors(truth, prediction.displacement)
        regions = {"loaded_region": self._near(path)}
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
                load_factor=float(self._store.load_factors[level]),
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
        return ModelErrors(
            name=self._name,
            by_component=self._pooled.by_component(),
            by_region=self._pooled.by_region(),
            by_level=self._pooled.by_level(),
            histogram=self._pooled.components["euclidean"].histogram(),
            summary=summarise_samples(self._samples),
            samples=tuple(self._samples),
        )
