"""From a method and a task's data to a result."""

import csv
import os
import platform
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import torch

from physgnn.dataset.splits.samples import MESH
from physgnn.dataset.training_loads import strongest_forces
from physgnn.errors import InputError
from physgnn.evaluation.benchmark.job import MethodOnTask
from physgnn.evaluation.benchmark.peak_memory import PeakMemory
from physgnn.evaluation.benchmark.result import (
    FAILED,
    MEASURED,
    NOT_APPLICABLE,
    BenchmarkResult,
    Errors,
    is_finite,
)
from physgnn.evaluation.measure.measuring import measure
from physgnn.evaluation.measure.rows import Row
from physgnn.learning.models import build_model
from physgnn.learning.network import Network
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import processor_minutes
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.lightning_module import VALIDATION_LOSS
from physgnn.learning.training.training_run import train
from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.prediction import Predict, Prediction
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress
from physgnn.versions import release

LIBRARIES = ("physgnn", "numpy", "scipy", "scikit-learn", "torch", "lightning")


def run_job(job: MethodOnTask, *, progress: Progress | None = None) -> BenchmarkResult:
    """Train or fit a method, and measure it; whatever it raises makes it failed.

    A training that was interrupted goes on.

    Parameters
    ----------
    job : MethodOnTask
        What to do.
    progress : callable, optional
        Called with (done, total, text).

    Returns
    -------
    BenchmarkResult
        Errors, or the reason why there are none.
    """
    empty = BenchmarkResult(
        job.identity, NOT_APPLICABLE, versions=_versions(), machine=_machine()
    )
    try:
        reason = _not_applicable(job)
        if reason:
            return replace(empty, reason=reason)
        return _measured(job, empty, progress)
    except Exception as error:  # a method may be a stranger's: others go on
        return replace(empty, status=FAILED, reason=_line(error))


def _not_applicable(job: MethodOnTask) -> str:
    data, held_out = job.data, job.data.held_out
    if issubclass(job.kind, Network) and data.split.name == MESH:
        other = job.kind.share_weights is not Network.share_weights
        return "" if other else "what it learns belongs to one mesh"
    if not job.kind.applies_to(data.store, held_out.train, held_out.test):
        if data.split.name == MESH and job.kind.learns:
            return "what it learns belongs to one mesh"
        return "it has nothing to learn these samples from"
    return ""


def _measured(
    job: MethodOnTask, empty: BenchmarkResult, progress: Progress | None
) -> BenchmarkResult:
    with PeakMemory() as memory:
        if issubclass(job.kind, Network):
            minutes, predictor = _trained(job, progress)
            row = Row(job.method.name, lambda: predictor, minutes=minutes)
        else:
            row = Row(job.method.name, lambda: _fitted(job))
        row = replace(
            row,
            make=_checking(row, job.data.store.mesh.n_points),
            seed=empty.identity.seed,
            tolerance_mm=job.method.tolerance_mm,
        )
        measured = measure(row, job.data.held_out, progress=progress)
    if not is_finite(measured):
        raise InputError("its errors are not finite numbers")
    return replace(
        empty,
        status=MEASURED,
        errors=Errors.of(measured),
        processor_minutes=measured.minutes if job.kind.learns else 0.0,
        milliseconds=1e3 * measured.summary.median_seconds,
        memory_mb=memory.mb,
        curve=_curve(job.run),
    )


def _fitted(job: MethodOnTask) -> Predict:
    surrogate = build_model(job.method.model, job.data.store.body, **job.method.options)
    surrogate.fit(job.data.store, job.data.held_out.train, job.seed)
    return Predictor(surrogate)


def _trained(job: MethodOnTask, progress: Progress | None) -> tuple[float, Predict]:
    """Return a network's minutes of training and its predictor."""
    run = RunFolder(job.run)
    if run.model_card.exists():  # written last: `repaired` finds the network trained
        checkpoint = Checkpoint.load(run.path)
    else:
        checkpoint = _train(job, run, progress)
    minutes = processor_minutes(checkpoint.record)
    store = job.data.store
    if job.data.split.name == MESH:
        forces = strongest_forces(store, store.samples())
        checkpoint = adapt(checkpoint, store.body, forces)
    elif job.method.tolerance_mm is not None:
        if not all(file.exists() for file in run.calibrations):
            calibrate_run(run.path, store, job.data.split, progress=progress)
        return minutes, Predictor.load(run.path)
    return minutes, _without_bounds(checkpoint)


def _train(job: MethodOnTask, run: RunFolder, progress: Progress | None) -> Checkpoint:
    """Train a network, or go on with it."""
    stores, splits = job.data.trained_on
    config = TrainingConfig(
        job.method.model,
        options=job.method.options,
        max_minutes=job.minutes,
        seed=job.seed,
        **job.method.training,
    )
    resume = run.state.exists()
    if not resume:
        shutil.rmtree(run.path, ignore_errors=True)  # what a kill left is of no use
    return train(stores, splits, config, run.path, progress=progress, resume=resume)


def _without_bounds(checkpoint: Checkpoint) -> Predict:
    """Return a predictor that spends no time on bounds, as no other method does."""
    checkpoint.model.prepare()
    return Predictor(checkpoint.model)


def _checking(row: Row, n_points: int) -> Any:
    """Return a row's maker that refuses predictions that are no displacement."""

    def make() -> Predict:
        predict = row.make()

        def checked(*case: Any, **options: Any) -> Prediction:
            found = predict(*case, **options)
            displacement = np.asarray(found.displacement)
            if displacement.shape != (n_points, 3):
                raise InputError(
                    f"predict must return an array of shape ({n_points}, 3) (got "
                    f"{displacement.shape})"
                )
            if not np.isfinite(displacement).all():
                raise InputError("predict returned numbers that are not finite")
            return found

        return checked

    return make


def _curve(run: Path) -> tuple[tuple[float, float], ...]:
    """Return minutes and validation loss of every epoch; none of what has no epochs."""
    file = RunFolder(run).metrics
    if not file.is_file():
        return ()
    with file.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return tuple((float(row["minutes"]), float(row[VALIDATION_LOSS])) for row in rows)


def _versions() -> dict[str, str]:
    return {"python": platform.python_version(), **{k: release(k) for k in LIBRARIES}}


def _machine() -> dict[str, Any]:
    return {
        "system": platform.platform(),
        "processor": platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "threads": torch.get_num_threads(),
        "load": psutil.getloadavg()[0],
    }


def _line(error: Exception) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, InputError):
        return text
    return f"{type(error).__name__}: {text}".rstrip(": ")
