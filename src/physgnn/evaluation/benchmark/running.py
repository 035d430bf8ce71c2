"""From a method and a task's data to a result."""

import os
import platform
from dataclasses import replace
from typing import Any

import psutil
import torch

from physgnn.errors import InputError
from physgnn.evaluation.benchmark.job import MethodOnTask, TaskData
from physgnn.evaluation.benchmark.load_measuring import (
    measured_on_loads,
    why_no_loads,
)
from physgnn.evaluation.benchmark.network_training import curve
from physgnn.evaluation.benchmark.peak_memory import PeakMemory
from physgnn.evaluation.benchmark.result import (
    FAILED,
    MEASURED,
    NOT_APPLICABLE,
    BenchmarkResult,
    Errors,
    is_finite,
)
from physgnn.evaluation.benchmark.shift_measuring import (
    measured_on_shifts,
    why_no_shifts,
)
from physgnn.evaluation.measure.result import ModelErrors
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
        with PeakMemory() as memory:
            measured = _measured(job, progress)
    except Exception as error:  # a method may be a stranger's: others go on
        return replace(empty, status=FAILED, reason=_line(error))
    if not is_finite(measured):
        return replace(empty, status=FAILED, reason="its errors are not finite numbers")
    return replace(
        empty,
        status=MEASURED,
        errors=Errors.of(measured),
        processor_minutes=measured.minutes if job.kind.learns else 0.0,
        milliseconds=1e3 * measured.summary.median_seconds,
        memory_mb=memory.mb,
        curve=curve(job.run),
    )


def _not_applicable(job: MethodOnTask) -> str:
    if isinstance(job.data, TaskData):
        return why_no_loads(job, job.data)
    return why_no_shifts(job, job.data)


def _measured(job: MethodOnTask, progress: Progress | None) -> ModelErrors:
    if isinstance(job.data, TaskData):
        return measured_on_loads(job, job.data, progress)
    return measured_on_shifts(job, job.data, progress)


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
