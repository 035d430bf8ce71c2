"""One patient of a batch, from cells to files."""

import inspect
import shutil
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from physgnn import stages
from physgnn.errors import InputError
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.vtk.prediction_file import StoredStatus, read_status
from physgnn.stages.cohort.patient_table import Patient
from physgnn.stages.cohort.planning import Call, StepError, plan
from physgnn.stages.cohort.record import PatientRecord
from physgnn.stages.cohort.step_table import NOT_OK, REASONS, STATUS, Figures

LOG = "log.txt"
Outcome = Literal["ok", "not ok", "failed"]


@dataclass(frozen=True)
class PatientResult:
    """How a patient of a batch fared.

    Attributes
    ----------
    name : str
    outcome : str
        "ok"; "not ok" if a displacement was written that must not be relied on;
        "failed" if a step could not be done.
    step, reason : str
        Which, and why.
    seconds : float
        Spent now; 0 if all was there already.
    figures : mapping
        Of all steps.
    """

    name: str
    outcome: Outcome
    step: str = ""
    reason: str = ""
    seconds: float = 0.0
    figures: Figures = field(default_factory=dict)

    @property
    def said(self) -> str:
        """Outcome or, where it is ok, the status; step and reason; in one line."""
        status = self.figures.get(STATUS) if self.outcome == "ok" else None
        parts = (str(status or self.outcome), self.step, self.reason)
        return ": ".join(part for part in parts if part)


def run_patient(
    patient: Patient, tables: Path, folder: Path, doing: Callable[[str], None]
) -> PatientResult:
    """Do what a patient's cells ask for and is not done yet.

    Parameters
    ----------
    patient : Patient
    tables : Path
        Folder that paths in cells start from.
    folder : Path
        The patient's own; it is made.
    doing : callable
        Called with every step's name before it begins.
    """
    start, figures, step = time.perf_counter(), Figures(), ""
    lines: list[str] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        calls = plan(patient, tables, folder)
        record = PatientRecord.read(folder)
        for call in calls:
            step = call.step.command
            doing(step)
            figures |= _done(call, record, lines)
    except StepError as error:
        return _failed(patient, error.step, str(error), start, figures)
    except InputError as error:
        return _failed(patient, step, str(error), start, figures)
    except (OSError, MemoryError) as error:
        reason = f"{type(error).__name__}: {error}"
        return _failed(patient, step, reason, start, figures)
    except Exception as error:
        lines += traceback.format_exception(error)
        reason = f"an error in physgnn itself ({error!r}), see {folder / LOG}"
        return _failed(patient, step, reason, start, figures)
    finally:
        if lines:
            write_whole(folder / LOG, "\n".join(lines) + "\n")
    is_usable = not figures.pop(NOT_OK, False)
    return PatientResult(
        patient.name,
        "ok" if is_usable else "not ok",
        step="" if is_usable else step,
        reason="" if is_usable else str(figures.get(REASONS, "")),
        seconds=time.perf_counter() - start if lines else 0.0,
        figures=figures,
    )


def _done(call: Call, record: PatientRecord, lines: list[str]) -> Figures:
    """Do a step unless it is done; return its figures."""
    known = record.figures_of(call)
    if known is not None:
        return known
    record.begin(call)
    if call.out.is_dir() and not call.resumes:
        shutil.rmtree(call.out)  # what a step before left or did not finish
    lines.append(f"{call.step.command} -> {call.out.name}")
    function = getattr(stages, call.step.command)
    shown = inspect.signature(function).parameters
    callbacks = {"log": lines.append} if "log" in shown else {}
    made = function(**call.arguments, **call.written, **callbacks)
    figures = {**_of_given(call), **call.step.figures(made)}
    record.end(call, figures)
    return figures


def _of_given(call: Call) -> Figures:
    """Say of a displacement that a step was given that it is not ok."""
    given = call.arguments.get("prediction")
    stored = StoredStatus() if given is None else read_status(given)
    if stored.usable:
        return {}
    return {STATUS: stored.status, REASONS: "; ".join(stored.reasons), NOT_OK: True}


def _failed(
    patient: Patient, step: str, reason: str, start: float, figures: Figures
) -> PatientResult:
    figures.pop(NOT_OK, None)
    line = " ".join(reason.split())
    seconds = time.perf_counter() - start
    return PatientResult(patient.name, "failed", step, line, seconds, figures)
