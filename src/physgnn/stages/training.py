"""From a dataset to a trained run with calibrated bounds."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn.dataset import Store, named_split
from physgnn.errors import InputError
from physgnn.progress import Progress

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.checkpoint import Checkpoint
    from physgnn.learning.training_config import TrainingConfig


def train(
    store: str | Path,
    split: str,
    config: "TrainingConfig",
    run: str | Path,
    *,
    progress: Progress | None = None,
    **options: Any,
) -> "Checkpoint":
    """Train on a split of a dataset and calibrate the error bounds.

    Parameters
    ----------
    store, run : path
        The dataset, and the folder to train into.
    split : str
        A row of ``SPLITS``.
    config : TrainingConfig
        How to train.
    progress, **options
        See `physgnn.learning.train`.
    """
    from physgnn.learning.training import is_first_process
    from physgnn.learning.training import train as train_network
    from physgnn.prediction.predictor import calibrate_run

    # Training keeps what it read in a file: the store needn't keep it too.
    opened = Store.open(store, cache_bytes=128 * 2**20)
    parts = named_split(split, opened)
    checkpoint = train_network(opened, parts, config, run, progress=progress, **options)
    if is_first_process():
        calibrate_run(run, opened, parts, progress=progress)
    return checkpoint


def store_of(run: str | Path) -> Path:
    """Return the dataset a run was trained on, as its record names it."""
    try:
        record = json.loads((Path(run) / "run.json").read_text("utf-8"))
        return Path(record["data"]["path"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{run} is no run folder: it has no readable run.json; train one, or name "
            "the dataset with --store"
        ) from error
