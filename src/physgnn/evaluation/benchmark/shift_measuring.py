"""A method measured where a shift was measured: registrations and their peers."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.evaluation.benchmark.job import MethodOnTask
from physgnn.evaluation.benchmark.load_measuring import check_displacement
from physgnn.evaluation.benchmark.methods import SURFACE_NETWORK
from physgnn.evaluation.benchmark.network_training import trained
from physgnn.evaluation.benchmark.shift_data import ShiftData
from physgnn.evaluation.in_silico.compared import SHIFT_METHODS, ShiftMeasured
from physgnn.evaluation.measure.measuring import ErrorGatherer
from physgnn.evaluation.measure.result import ModelErrors
from physgnn.geometry.measured import SurfacePoints
from physgnn.learning.grid_networks.known_surface import (
    FromKnownDisplacement,
    matched_displacement,
    seen_points,
)
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.record import processor_minutes
from physgnn.prediction.prediction import Prediction, PredictionStatus
from physgnn.progress import Progress

WHOLE = np.ones(1)  # the load factor of a shift
Displacement = Callable[[ShiftMeasured], FloatArray]


def why_no_shifts(job: MethodOnTask, data: ShiftData) -> str:
    """Return why a method does not apply to a registration; empty if it does."""
    name = job.method.name
    if name in SHIFT_METHODS:
        return ""
    if name != SURFACE_NETWORK:
        return "it takes a load, and here a displacement was measured"
    if data.measured != "surface":
        return "it takes the displacement of a whole exposed surface"
    return ""


def measured_on_shifts(
    job: MethodOnTask, data: ShiftData, progress: Progress | None
) -> ModelErrors:
    """Return a method's errors on the shifts, after its training if it learns."""
    minutes, displacement = _method(job, data, progress)
    gatherer = ErrorGatherer(job.method.name, data.truth.mesh, WHOLE)
    status = PredictionStatus.NO_ERROR_ESTIMATE
    for number, case in enumerate(data.cases):
        begun = time.perf_counter()
        found = np.asarray(displacement(data.given(case)))
        seconds = time.perf_counter() - begun
        check_displacement(found, data.truth.mesh.n_points)
        prediction = Prediction(found, None, status, seconds)
        gatherer.add((number, 0), case.displacement, prediction, data.near)
        if progress is not None:
            progress(number + 1, len(data.cases), "registering")
    seed = job.identity.seed
    return replace(gatherer.result(), seed=seed, minutes=minutes)


def _method(
    job: MethodOnTask, data: ShiftData, progress: Progress | None
) -> tuple[float, Displacement]:
    """Return minutes of training, and what answers a measured shift."""
    if job.method.name in SHIFT_METHODS:
        method = SHIFT_METHODS[job.method.name]
        return 0.0, lambda measured: method(data.body, measured)
    checkpoint = trained(job, *data.trained_on, progress)
    minutes = processor_minutes(checkpoint.record)
    nothing = np.zeros((0, data.registered.mesh.n_points, 3))
    network = adapt(checkpoint, data.registered, nothing).model
    if not isinstance(network, FromKnownDisplacement):
        raise InputError(f"method '{job.method.name}' takes no displacement")
    return minutes, _from_surface(network, data)


def _from_surface(network: FromKnownDisplacement, data: ShiftData) -> Displacement:
    body = data.registered
    seen = seen_points(body, data.body.craniotomy_point)

    def displacement(measured: ShiftMeasured) -> FloatArray:
        assert isinstance(measured, SurfacePoints)
        known = matched_displacement(body, seen, measured.points)
        return data.body.at_truth(network.displacement_from(known))

    return displacement
