"""A method measured where loads are given."""

from dataclasses import replace
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.dataset.splits.samples import MESH
from physgnn.dataset.training_loads import strongest_forces
from physgnn.errors import InputError
from physgnn.evaluation.benchmark.job import MethodOnTask, TaskData
from physgnn.evaluation.benchmark.methods import SHIFTS_ONLY
from physgnn.evaluation.benchmark.network_training import trained
from physgnn.evaluation.measure.measuring import measure
from physgnn.evaluation.measure.result import ModelErrors
from physgnn.evaluation.measure.rows import Row
from physgnn.learning.models import build_model
from physgnn.learning.network import Network
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import processor_minutes
from physgnn.learning.surrogate import Surrogate
from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.prediction import Predict, Prediction
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress

ONE_MESH = "what it learns belongs to one mesh"


def why_no_loads(job: MethodOnTask, data: TaskData) -> str:
    """Return why a method does not apply to a task; empty if it does."""
    held_out, kind = data.held_out, job.kind
    if job.method.name in SHIFTS_ONLY:
        return "it takes what was measured of a shift, and here a load is given"
    if issubclass(kind, Network) and data.split.name == MESH:
        other = kind.share_weights is not Network.share_weights
        return "" if other else ONE_MESH
    if not kind.applies_to(data.store, held_out.train, held_out.test):
        if data.split.name == MESH and kind.learns:
            return ONE_MESH
        return "it has nothing to learn these samples from"
    return ""


def measured_on_loads(
    job: MethodOnTask, data: TaskData, progress: Progress | None
) -> ModelErrors:
    """Train or fit a method, and return its errors on the test samples."""
    if issubclass(job.kind, Network):
        minutes, predictor = _trained(job, data, progress)
        row = Row(job.method.name, lambda: predictor, minutes=minutes)
        row = replace(row, case=predictor.surrogate.sample_case)
    else:
        row = Row(job.method.name, lambda: Predictor(_fitted(job, data)))
    row = replace(
        row,
        make=_checking(row, data.store.mesh.n_points),
        seed=job.identity.seed,
        tolerance_mm=job.method.tolerance_mm,
    )
    return measure(row, data.held_out, progress=progress)


def check_displacement(displacement: FloatArray, n_points: int) -> None:
    """Raise InputError unless it is finite, with a row a point."""
    if displacement.shape != (n_points, 3):
        raise InputError(
            f"predict must return an array of shape ({n_points}, 3) (got "
            f"{displacement.shape})"
        )
    if not np.isfinite(displacement).all():
        raise InputError("predict returned numbers that are not finite")


def _fitted(job: MethodOnTask, data: TaskData) -> Surrogate:
    surrogate = build_model(job.method.model, data.store.body, **job.method.options)
    surrogate.fit(data.store, data.held_out.train, job.seed)
    return surrogate


def _trained(
    job: MethodOnTask, data: TaskData, progress: Progress | None
) -> tuple[float, Predictor]:
    """Return a network's minutes of training and its predictor."""
    run, store = RunFolder(job.run), data.store
    checkpoint = trained(job, *data.trained_on, progress)
    minutes = processor_minutes(checkpoint.record)
    if data.split.name == MESH:
        forces = strongest_forces(store, store.samples())
        checkpoint = adapt(checkpoint, store.body, forces)
    elif job.method.tolerance_mm is not None:
        if not all(file.exists() for file in run.calibrations):
            calibrate_run(run.path, store, data.split, progress=progress)
        return minutes, Predictor.load(run.path)
    return minutes, _without_bounds(checkpoint)


def _without_bounds(checkpoint: Checkpoint) -> Predictor:
    """Return a predictor that spends no time on bounds, as no other method does."""
    checkpoint.model.prepare()
    return Predictor(checkpoint.model)


def _checking(row: Row, n_points: int) -> Any:
    """Return a row's maker that refuses predictions that are no displacement."""

    def make() -> Predict:
        predict = row.make()

        def checked(*case: Any, **options: Any) -> Prediction:
            found = predict(*case, **options)
            check_displacement(np.asarray(found.displacement), n_points)
            return found

        return checked

    return make
