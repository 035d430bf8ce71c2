"""Evaluate a trained run: tables, figures and the report, in its folder."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset.split import SPLITS, Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.baselines import baselines
from physgnn.evaluation.evaluate import evaluate
from physgnn.evaluation.facts import (
    bound_facts,
    case_facts,
    model_facts,
    provenance_facts,
    time_facts,
)
from physgnn.evaluation.figures import draw_figures
from physgnn.evaluation.report import write_report
from physgnn.evaluation.result import Report
from physgnn.evaluation.tables import accuracy_table
from physgnn.learning.checkpoint import Checkpoint, check_mesh
from physgnn.learning.model_card import write_model_card
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.predictor import Predictor
from physgnn.progress import Progress

SOLVED_CASES = 3  # cold finite-element solves timed beside the model


def evaluate_run(
    run: str | Path,
    store_path: str | Path,
    split: str | Split = "path",
    *,
    command: str = "",
    progress: Progress | None = None,
) -> Report:
    """Evaluate a run on a split's test samples and write ``run/evaluation-<split>/``.

    The folder gets metrics.json, report.html and figures/.

    Parameters
    ----------
    run : path
        Folder of a trained model.
    store_path : path
        The dataset, on the same mesh.
    split : str or Split
        A row of `SPLITS`, with its default seed, or the samples themselves.
    command : str
        What was called, for the report.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Raises
    ------
    InputError
        If the mesh is another, the split is unknown, or the run was trained on some
        of the test samples.
    """
    run = Path(run)
    checkpoint, predictor = Checkpoint.load(run), Predictor.load(run)
    store = Store.open(store_path)
    check_mesh(checkpoint.record, store.mesh, run)
    split = split if isinstance(split, Split) else named_split(split, store)
    check_unseen(checkpoint, store, split)
    name = checkpoint.record["config"]["model"]
    predictors = baselines(store, split.train, split.test) | {name: predictor}
    solver_seconds = solve_seconds(predictor, store, split.test)
    report = evaluate(
        predictors, store, split.test, split=split.name, progress=progress
    )
    model_seconds = report.model(name).summary.median_seconds
    report = report.with_facts(
        case=case_facts(store),
        model=model_facts(checkpoint),
        bounds=bound_facts(predictor.calibration),
        time=time_facts(store, solver_seconds, model_seconds),
        provenance=provenance_facts(store, checkpoint, command),
        solver_seconds=solver_seconds,
    )
    write_evaluation(report, store, predictor, run / f"evaluation-{split.name}")
    write_model_card(run, errors=accuracy_table(report).text())
    return report


def write_evaluation(
    report: Report, store: Store, predictor: Predictor, folder: Path
) -> None:
    """Write metrics.json, figures/ and report.html into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    report.write(folder / "metrics.json")
    pictures = draw_figures(report, store, predictor, folder / "figures")
    write_report(report, pictures, folder / "report.html")


def named_split(name: str, store: Store) -> Split:
    """Return a split by its name; InputError names those there are."""
    if name not in SPLITS:
        raise InputError(f"no split '{name}' (there are: {', '.join(sorted(SPLITS))})")
    return SPLITS[name](store)


def check_unseen(checkpoint: Checkpoint, store: Store, split: Split) -> None:
    """Raise InputError if the run was trained on some of the test samples."""
    record = checkpoint.record
    if record["data"]["hash"] != store.content_hash():
        return  # other data, made for this evaluation
    trained = named_split(record["split"]["name"], store)
    seen = {tuple(row) for row in np.concatenate([trained.train, trained.validation])}
    overlap = sum(tuple(row) in seen for row in split.test)
    if overlap:
        raise InputError(
            f"the run was trained with split '{trained.name}', on {overlap} of the "
            f"{len(split.test)} test samples of split '{split.name}': evaluate it "
            f"with --split {trained.name}, or train with --split {split.name}"
        )


def solve_seconds(
    predictor: Predictor, store: Store, samples: NDArray[np.int64]
) -> float:
    """Return the median time of a finite-element solve of a few of the samples."""
    solver = FiniteElementPredictor(predictor.body)
    picks = np.linspace(0, len(samples) - 1, min(SOLVED_CASES, len(samples)))
    cases = [store.load_case(*samples[round(pick)]) for pick in picks]
    return float(np.median([solver(case).seconds for case in cases]))
