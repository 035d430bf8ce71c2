"""Evaluate trained runs: tables, figures and the report, in a folder."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.splits.samples import MESH, Split
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.baselines import baseline_rows, named_baselines
from physgnn.evaluation.measure.cached_rows import CachedRows
from physgnn.evaluation.measure.coverage import (
    BarSample,
    bar_facts,
    measure_bars,
    write_bars,
)
from physgnn.evaluation.measure.gentle_loads import find_gentle_loads
from physgnn.evaluation.measure.held_out import HeldOut, check_unseen
from physgnn.evaluation.measure.measuring import evaluate
from physgnn.evaluation.measure.result import Report
from physgnn.evaluation.measure.rows import Row, load_predictor, repaired_row, run_rows
from physgnn.evaluation.report.facts import (
    bound_facts,
    case_facts,
    model_facts,
    provenance_facts,
    time_facts,
)
from physgnn.evaluation.report.figures import draw_bars, draw_figures
from physgnn.evaluation.report.page import write_report
from physgnn.evaluation.report.tables import accuracy_table
from physgnn.learning.runs.checkpoint import Checkpoint, read_record
from physgnn.learning.runs.folder import EvaluationFolder, RunFolder
from physgnn.learning.runs.model_card import write_model_card
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress

SOLVED_CASES = 3  # cold finite-element solves timed beside the model


@dataclass(frozen=True)
class Comparison:
    """What stands beside the runs.

    Parameters
    ----------
    baselines : str
        ``quick``, ``all``, or names of methods with commas between; those that do
        not apply to the split are left out.
    tolerance_mm : float or None
        Adds the last run's first seed with every prediction made to keep this.
    precision : str
        Of the runs' predictions, as in `Predictor.load`.
    """

    baselines: str = "quick"
    tolerance_mm: float | None = None
    precision: str = "float32"


def evaluate_runs(
    runs: Sequence[str | Path],
    store_path: str | Path,
    split: str | Split = "path",
    *,
    comparison: Comparison = Comparison(),
    out: Path | None = None,
    command: str = "",
    progress: Progress | None = None,
) -> Report:
    """Evaluate runs on a split's test samples, beside baselines, in one table.

    The folder gets metrics.json, report.html, figures/ and rows/: what was measured
    there before is not measured again.

    Parameters
    ----------
    runs : sequence of paths
        Folders of trained models, the one that the report is about last. Those that
        differ in their seed alone make one row.
    store_path : path
        The dataset, on the mesh of the runs or, for split ``mesh``, on another.
    split : str or Split
        A row of `physgnn.dataset.SPLITS`, with its default seed, or ``mesh``, or the
        samples.
    comparison : Comparison
        What stands beside them.
    out : path, optional
        By default ``evaluation-<split>`` in the last run's folder.
    command : str
        What was called, for the report.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Returns
    -------
    Report
        Errors of each row of the table, mm, and its seconds.

    Raises
    ------
    InputError
        If the mesh is another, the split is unknown, or a run was trained on some of
        the test samples.
    """
    folders = [Path(run) for run in runs]
    held_out = HeldOut.of(Store.open(store_path), split)
    for run in folders:
        check_unseen(read_record(run), held_out, run)
    rows = _rows(folders, held_out, comparison)
    run = folders[-1]
    files = EvaluationFolder(out) if out else RunFolder(run).evaluation(held_out.split)
    cached = CachedRows(files.rows, held_out)
    report = evaluate(rows, held_out, cached=cached, progress=progress)
    predictor = load_predictor(run, held_out.store, comparison.precision)
    bars = measure_bars(predictor, held_out, progress=progress)
    report = report.with_facts(
        **_facts(report, held_out, predictor, run, command), error_bars=bar_facts(bars)
    )
    write_evaluation(report, held_out.store, predictor, files.path, bars)
    write_model_card(run, errors=accuracy_table(report).text())
    return report


def evaluate_run(
    run: str | Path, store_path: str | Path, split: str | Split = "path", **options: Any
) -> Report:
    """Evaluate one run; as `evaluate_runs` of it alone.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    store_path, split, **options
        See `evaluate_runs`.

    Returns
    -------
    Report
        Errors of each row of the table, mm, and its seconds.
    """
    return evaluate_runs([run], store_path, split, **options)


def _rows(runs: Sequence[Path], held_out: HeldOut, comparison: Comparison) -> list[Row]:
    """Return baselines, runs and the repaired row, in the order of presentation."""
    tested = run_rows(runs, held_out.store, comparison.precision)
    seeds = sorted({row.seed for row in tested if row.seed is not None}) or [0]
    names = {row.name for row in tested}  # what is tested is no baseline of itself
    asked = named_baselines(comparison.baselines, held_out)
    baselines = [name for name in asked if name not in names]
    rows = baseline_rows(baselines, held_out, seeds=seeds)
    if comparison.tolerance_mm is not None:
        first = next(row for row in tested if row.name == tested[-1].name)
        rows.append(repaired_row(first, comparison.tolerance_mm))
    return rows + tested


def _facts(
    report: Report, held_out: HeldOut, predictor: Predictor, run: Path, command: str
) -> dict[str, Any]:
    store, checkpoint = held_out.store, Checkpoint.load(run)
    groups = "patients" if held_out.split == MESH else "load paths"
    solver_seconds = solve_seconds(predictor, store, held_out.test)
    model_seconds = report.models[-1].summary.median_seconds
    return {
        "case": case_facts(store),
        "model": model_facts(checkpoint),
        "bounds": bound_facts(predictor.calibration, groups),
        "time": time_facts(store, solver_seconds, model_seconds),
        "provenance": provenance_facts(store, checkpoint, command),
        "solver_seconds": solver_seconds,
        "gentle_loads": find_gentle_loads(store, held_out.test).to_json(),
    }


def write_evaluation(
    report: Report,
    store: Store,
    predictor: Predictor,
    folder: Path,
    bars: Sequence[BarSample] = (),
) -> None:
    """Write metrics.json, error-bars.json, figures/ and report.html into a folder.

    Parameters
    ----------
    report : Report
        What was measured.
    store : Store
        The dataset that it was measured on.
    predictor : Predictor
        Of the run that the report is about; it draws the scenes.
    folder : path
        Where the files go; made if it is not there.
    bars : sequence of BarSample
        Errors and their bounds; without any, there is no figure of them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = EvaluationFolder(folder)
    report.write(files.metrics)
    write_bars(bars, files.error_bars)
    pictures = draw_figures(report, store, predictor, files.figures)
    if bars:
        pictures = (*pictures, draw_bars(bars, files.figures))
    write_report(report, pictures, files.report)


def solve_seconds(predictor: Predictor, store: Store, samples: IntArray) -> float:
    """Return the median time of a finite-element solve of a few of the samples."""
    solver = FiniteElementPredictor(predictor.body)
    picks = np.linspace(0, len(samples) - 1, min(SOLVED_CASES, len(samples)))
    cases = [store.load_case(*samples[round(pick)]) for pick in picks]
    return float(np.median([solver(case).seconds for case in cases]))
