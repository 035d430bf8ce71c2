"""A network of the benchmark: trained, gone on with, or trained already."""

import csv
import shutil
from collections.abc import Sequence
from pathlib import Path

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.benchmark.job import MethodOnTask
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.lightning_module import VALIDATION_LOSS
from physgnn.learning.training.training_run import train
from physgnn.progress import Progress


def trained(
    job: MethodOnTask,
    stores: Sequence[Store],
    splits: Sequence[Split],
    progress: Progress | None,
) -> Checkpoint:
    """Return a job's trained network, however much of its training is still to do."""
    run = RunFolder(job.run)
    if run.model_card.exists():  # written last: `repaired` finds the network trained
        return Checkpoint.load(run.path)
    config = TrainingConfig(
        job.method.model,
        options=job.method.options,
        max_minutes=job.minutes,
        seed=job.seed,
        **job.method.training,
    )
    resume = run.state.exists()
    if not resume:
        shutil.rmtree(run.path, ignore_errors=True)  # what a kill left is of no use
    return train(stores, splits, config, run.path, progress=progress, resume=resume)


def curve(run: Path) -> tuple[tuple[float, float], ...]:
    """Return minutes and validation loss of every epoch; none of what has no epochs."""
    file = RunFolder(run).metrics
    if not file.is_file():
        return ()
    with file.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return tuple((float(row["minutes"]), float(row[VALIDATION_LOSS])) for row in rows)
