"""The states of an operation, registered one after the other into a folder.

Each has its displacement, ``NAME.vtu``, and its misfits, ``NAME-misfits.csv``;
``results.csv`` has a row a state, ``series.pvd`` is what ParaView opens. What is done
is in ``states.json``, with the digest of all that it was made from.
"""

import csv
import io
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.io.displacement_files import form_of
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.integrity.digest import digest_of, digest_of_file
from physgnn.io.vtk.prediction_file import read_displacement
from physgnn.progress import Log, no_log
from physgnn.stages.patient.intraoperative.one_state import (
    HowToRegister,
    register_state,
    write_state,
)
from physgnn.stages.patient.intraoperative.patient_body import (
    PatientBody,
)
from physgnn.stages.patient.intraoperative.state_table import StateRow

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.registration.registrar import Registrar
from physgnn.registration.result import Registration

RESULTS, PVD, RECORD = "results.csv", "series.pvd", "states.json"
COLUMNS = (
    "status", "reasons", "largest_mm", "bound_mean_mm", "bound_max_mm", "misfit_mm",
    "held_out_mm", "outliers", "offset_mm", "bone",
)  # fmt: skip


@dataclass(frozen=True)
class StateResult:
    """How a state of a series fared.

    Attributes
    ----------
    name : str
        Of the state.
    time : float or None
        As in the table.
    outcome : str
        "ok"; "not ok" if its displacement must not be relied on; "failed" if there is
        none.
    reason : str
        Why it is not ok.
    seconds : float
        Spent now; 0 if it was there already.
    figures : mapping
        Its columns in the table of results.
    """

    name: str
    time: float | None
    outcome: str
    reason: str = ""
    seconds: float = 0.0
    figures: dict[str, Any] = field(default_factory=dict)

    @property
    def said(self) -> str:
        """Status of a displacement that may be used; else outcome and reason."""
        if self.outcome == "ok":
            return str(self.figures["status"])
        return f"{self.outcome}: {self.reason}" if self.reason else self.outcome


def register_states(
    patient: PatientBody,
    states: Sequence[StateRow],
    out: Path,
    how: HowToRegister,
    *,
    log: Log = no_log,
) -> tuple[StateResult, ...]:
    """Register states in order, each beginning where the one before ended.

    A second call does what is missing. A state that fails does not stop the others.

    Parameters
    ----------
    patient : PatientBody
        Whose.
    states : sequence of StateRow
        In order.
    out : Path
        Folder; made if it is missing.
    how : HowToRegister
        As of one state.
    log : callable
        Called with a line for each state, and with what registration says.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"{out} is a file: a series needs the name of a folder")
    out.mkdir(parents=True, exist_ok=True)
    series = StateSeries(patient, out, how, log)
    for state in states:
        one = series.result_of(state)
        log(f"{one.name}: {one.said} ({one.seconds:.1f} s)")
    return tuple(series.results)


class StateSeries:
    """A folder of states: what is done, and where the last one ended.

    Parameters
    ----------
    patient : PatientBody
        Whose.
    out : Path
        The folder; it is there.
    how : HowToRegister
        As of one state.
    log : callable
        Called with what registration says, after the state's name.

    Attributes
    ----------
    results : list of StateResult
        So far.
    last : Registration or None
        Of the last state, if it was registered now.
    """

    def __init__(
        self, patient: PatientBody, out: Path, how: HowToRegister, log: Log
    ) -> None:
        self._patient, self._out, self._how, self._log = patient, out, how, log
        self.results: list[StateResult] = []
        self.last: Registration | None = None
        self._registrar: Registrar | None = None
        self._after: FloatArray | None = None
        self._done = _record(out / RECORD)
        mesh, body = patient.body.mesh, patient.body
        options = {"how": asdict(how), **patient.told}
        made_of = {"materials": repr(sorted(body.materials.items()))}
        self._common = digest_of(
            mesh.points, mesh.cells, mesh.region, body.fixed, options | made_of
        )

    def result_of(
        self, state: StateRow, named: Callable[[str], str] = str
    ) -> StateResult:
        """Return how the next state fares, registered now or before, and write it.

        `named` is given why it failed, and returns that with files called as their
        owner calls them.
        """
        self.last = None
        result = self._result_of(state)
        if result.outcome == "failed":
            result = replace(result, reason=named(result.reason))
        self.results.append(result)
        write_whole(self._out / RESULTS, results_text(self.results))
        write_whole(self._out / PVD, collection_text(self.results))
        return self.results[-1]

    def _result_of(self, state: StateRow) -> StateResult:
        start = time.perf_counter()
        file = self._out / f"{state.name}.vtu"
        try:
            inputs = self._digest(state)
            done = self._done.get(state.name, {})
            if done.get("inputs") == inputs and _is(file, done.get("output")):
                self._after = read_displacement(file)[1]
                figures = dict(done["figures"])
                return _result(state, figures, 0.0)
            figures = self._registered(state, file)
        except InputError as error:
            file.unlink(missing_ok=True)
            self._done.pop(state.name, None)
            seconds = time.perf_counter() - start
            return StateResult(state.name, state.time, "failed", str(error), seconds)
        self._done[state.name] = {
            "inputs": inputs,
            "output": digest_of_file(file),
            "figures": figures,
        }
        text = json.dumps(self._done, indent=1, allow_nan=False)
        write_whole(self._out / RECORD, text)
        return _result(state, figures, time.perf_counter() - start)

    def _registered(self, state: StateRow, file: Path) -> dict[str, Any]:
        from physgnn.registration.misfits import write_misfits

        if self._registrar is None:
            self._registrar = self._patient.make()
        found = register_state(
            self._registrar,
            state.files,
            self._how,
            resection=self._patient.resection,
            after=self._after,
            picture=self._out / f"{state.name}.png",
            log=lambda line: self._log(f"{state.name}: {line}"),
        ).found
        write_state(file, self._patient, found, form_of(file).write)
        write_misfits(self._out / f"{state.name}-misfits.csv", found.misfits)
        self._after, self.last = found.prediction.displacement, found
        return figures_of(found)

    def _digest(self, state: StateRow) -> str:
        files = {
            role: digest_of_file(path) if path.is_file() else str(path)
            for role, path in state.files.paths.items()
        }
        return digest_of(self._common, {"by": version("physgnn"), **files})


def figures_of(found: "Registration") -> dict[str, Any]:
    """Return what the table of results says of a registration."""
    prediction, bound = found.prediction, found.prediction.error_estimate_mm
    size = np.linalg.norm(prediction.displacement, axis=1)
    held_out = found.held_out_mm
    return {
        "status": str(prediction.status),
        "reasons": "; ".join(prediction.reasons),
        "usable": bool(prediction.status.usable),
        "largest_mm": round(float(size.max()), 4),
        "bound_mean_mm": None if bound is None else round(bound.mean_mm, 4),
        "bound_max_mm": None if bound is None else round(bound.max_mm, 4),
        "misfit_mm": round(float(found.misfit_mm), 4),
        "held_out_mm": round(held_out, 4) if np.isfinite(held_out) else None,
        "outliers": len(found.outliers),
        "offset_mm": round(found.offset.length_mm, 4),
        "bone": "" if found.bone is None else str(found.bone),
    }


def results_text(results: Sequence[StateResult]) -> str:
    """Return a row a state, as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["name", "time", "outcome", "reason", "seconds", *COLUMNS])
    for one in results:
        figures = [one.figures.get(name) for name in COLUMNS]
        told = [one.name, one.time, one.outcome, one.reason, f"{one.seconds:.1f}"]
        writer.writerow(["" if v is None else v for v in (*told, *figures)])
    return text.getvalue()


def collection_text(results: Sequence[StateResult]) -> str:
    """Return the states that there are as ParaView's collection of files.

    Where every state has a time they lie at it, else at their numbers from 1.
    """
    timed = all(one.time is not None for one in results)
    rows = [
        f"    <DataSet timestep={quoteattr(format(one.time if timed else i, '.10g'))} "
        f'part="0" file={quoteattr(f"{one.name}.vtu")}/>\n'
        for i, one in enumerate(results, 1)
        if one.outcome != "failed"
    ]
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
        f"  <Collection>\n{''.join(rows)}  </Collection>\n</VTKFile>\n"
    )


def _result(state: StateRow, figures: dict[str, Any], seconds: float) -> StateResult:
    is_ok = bool(figures["usable"])
    reason = "" if is_ok else str(figures["reasons"])
    outcome = "ok" if is_ok else "not ok"
    return StateResult(state.name, state.time, outcome, reason, seconds, figures)


def _is(file: Path, digest: object) -> bool:
    return file.is_file() and digest_of_file(file) == digest


def _record(path: Path) -> dict[str, Any]:
    """Return what is done; nothing where that cannot be read."""
    try:
        found = json.loads(path.read_text("utf-8"))
        return {str(name): dict(one) for name, one in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}
