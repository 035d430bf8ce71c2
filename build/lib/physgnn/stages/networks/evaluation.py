"""From trained runs to tables, figures and a report."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from physgnn.errors import InputError
from physgnn.learning.runs.folder import RunFolder
from physgnn.progress import Progress
from physgnn.stages.datasets.provenance import command_line
from physgnn.stages.outputs import Output, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.evaluation.measure.result import Report


@writes(out=Output(is_folder=True, inside=("runs",)))
def evaluate(
    runs: str | Path | Sequence[str | Path],
    *,
    split: str = "path",
    store: str | Path | None = None,
    baselines: str = "quick",
    tolerance_mm: float | None = None,
    out: str | Path | None = None,
    precision: str = "float32",
    progress: Progress | None = None,
) -> "Report":
    """Measure trained networks on held-out samples: tables, figures, report.

    Parameters
    ----------
    runs : path or sequence of paths
        Folders of trained models, the one that the report is about last. Those that
        differ in their seed alone make one row.
    split : str
        A row of ``SPLITS``, or ``mesh``, which needs `store`.
    store : path, optional
        Dataset; by default the one that the last run was trained on.
    baselines : str
        What to compare with: ``quick``, ``all``, or rows of
        `physgnn.learning.models.MODELS` with commas between.
    tolerance_mm : float, optional
        Adds a row of predictions that are repaired where they exceed this.
    out : path, optional
        Folder for the results; by default ``evaluation-<split>`` in the last run's.
    precision : str
        See `physgnn.prediction.Predictor.load`.
    progress : callable, optional
        Called with (done, total, text) after every sample.

    Returns
    -------
    Report
        The errors of every row of the table, as in ``metrics.json``; mm.

    Raises
    ------
    InputError
        If a folder or an option cannot be used, or a run was trained on some of the
        test samples.
    """
    from physgnn.evaluation.run_evaluation import Comparison, evaluate_runs

    folders = [runs] if isinstance(runs, str | Path) else list(runs)
    return evaluate_runs(
        folders,
        store_of(folders[-1]) if store is None else store,
        split,
        comparison=Comparison(baselines, tolerance_mm, precision),
        out=None if out is None else Path(out),
        command=command_line(),
        progress=progress,
    )


def store_of(run: str | Path) -> Path:
    """Return the dataset a run was trained on, where its record says.

    Raises
    ------
    InputError
        If there is no record, or no dataset where it says.
    """
    from physgnn.learning.runs.record import place_of_store, read_json

    try:
        return place_of_store(Path(run), read_json(RunFolder(Path(run)).record))
    except (KeyError, TypeError) as error:
        raise InputError(
            f"{run} is no run folder: its run.json names no dataset; train one, or "
            "name the dataset with --store"
        ) from error
