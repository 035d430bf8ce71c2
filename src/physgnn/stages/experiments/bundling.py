"""Make the model that comes with the package: the demonstration's, without the rest."""

import shutil
from dataclasses import replace
from pathlib import Path

from physgnn.bundled import BUNDLED_RUN
from physgnn.errors import InputError
from physgnn.learning.runs.folder import RunFolder
from physgnn.progress import Log, Show, no_log, no_show
from physgnn.stages.experiments.demonstration import DEMO
from physgnn.stages.experiments.pipeline import Pipeline
from physgnn.stages.experiments.recipe import RUN

MAX_BYTES = 5_000_000
MADE_BY = "make bundled"
BUNDLED = replace(
    DEMO,
    command="physgnn bundle",
    training_minutes=4.0,
    peers=("physgnn",),
    baselines="all",
    tolerance_mm=0.1,
)


def bundle(
    folder: str | Path,
    out: str | Path | None = None,
    *,
    show: Show = no_show,
    log: Log = no_log,
) -> Path:
    """Make the bundled model, some twenty minutes' work; return where it is.

    Parameters
    ----------
    folder : path
        Gets simulations, training and report; a second call goes on where one ended.
    out : path, optional
        Gets what predictions need, and the model card; by default the package itself.
    show, log : callables
        See `physgnn.stages.experiments.pipeline.Pipeline`.

    Raises
    ------
    InputError
        If it came out larger than the package may carry.
    """
    from physgnn.evaluation.report.tables import accuracy_table

    target = BUNDLED_RUN if out is None else Path(out)
    pipeline = Pipeline(Path(folder), BUNDLED.command, show, log)
    report = BUNDLED.follow(pipeline)
    slim_copy(pipeline.run(RUN).path, target, errors=accuracy_table(report).text())
    check_size(target)
    return target


def check_size(run: Path) -> None:
    """Raise InputError if a run is larger than the package may carry."""
    size = sum(file.stat().st_size for file in run.iterdir())
    if size > MAX_BYTES:
        raise InputError(
            f"{run} must have at most {MAX_BYTES} bytes (got {size}): use fewer points "
            "or modes"
        )


def slim_copy(run: Path, out: Path, *, errors: str) -> None:
    """Copy what predictions need of a run, without paths of the machine it's from.

    Parameters
    ----------
    run, out : Path
        Run folders.
    errors : str
        The section on errors of the model card, Markdown.
    """
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.runs.model_card import write_model_card
    from physgnn.prediction.error_bounds.calibration import Calibration

    files, copies = RunFolder(run), RunFolder(out)
    checkpoint = Checkpoint.load(run)
    data = {**checkpoint.record["data"], "path": MADE_BY, "paths": [MADE_BY]}
    data.pop("stores", None)
    out.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(files.case, copies.case)
    Checkpoint(checkpoint.model, {**checkpoint.record, "data": data}).save(out)
    for calibration in files.calibrations:
        Calibration.read(calibration).write(out / calibration.name)
    write_model_card(out, errors)
