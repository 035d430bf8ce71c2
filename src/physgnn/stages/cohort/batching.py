"""A table of patients to a folder for each, and one table of results."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from physgnn.io.integrity.atomic import write_whole
from physgnn.progress import Log, Progress, no_log
from physgnn.stages.cohort.patient_table import RESULTS, read_patients
from physgnn.stages.cohort.running import PatientResult, run_patient
from physgnn.stages.outputs import FOLDER, writes


@writes(out=FOLDER)
def batch(
    patients: str | Path,
    out: str | Path,
    *,
    progress: Progress | None = None,
    log: Log = no_log,
) -> tuple[PatientResult, ...]:
    """Take many patients through the stages that a table asks for.

    A second call does what is missing: a step is done anew only if what it is made from
    has changed. A patient that fails does not stop the others.

    Parameters
    ----------
    patients : path
        CSV: rows are patients, columns are ``name`` and the options of the stages mesh,
        adapt, predict, register and warp; see `physgnn.stages.cohort.columns`. Paths
        start from the CSV's folder.
    out : path
        Gets a folder for each patient, and results.csv.
    progress : callable, optional
        Called with the patients done, the patients in all, and what is being done.
    log : callable
        Called with a line for each patient that is not ok.

    Returns
    -------
    tuple of PatientResult
        In the order of the table.

    Raises
    ------
    InputError
        If the table cannot be used; then nothing is done.
    """
    table, folder = Path(patients), Path(out)
    rows = read_patients(table)
    folder.mkdir(parents=True, exist_ok=True)
    results: list[PatientResult] = []
    for i, patient in enumerate(rows):

        def doing(step: str, i: int = i, name: str = patient.name) -> None:
            if progress is not None:
                progress(i, len(rows), f"{name}: {step}")

        found = run_patient(patient, table.parent, folder / patient.name, doing)
        results.append(found)
        if found.outcome != "ok":
            log(f"{found.name}: {found.said}")
        write_whole(folder / RESULTS, results_text(results))
    return tuple(results)


def results_text(results: Sequence[PatientResult]) -> str:
    """Return results as CSV; columns of steps that nobody had are left out."""
    names = dict.fromkeys(name for result in results for name in result.figures)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["name", "outcome", "step", "reason", "seconds", *names])
    for one in results:
        figures = [one.figures.get(name) for name in names]
        writer.writerow(
            [one.name, one.outcome, one.step, one.reason, f"{one.seconds:.1f}"]
            + ["" if value is None else value for value in figures]
        )
    return text.getvalue()
