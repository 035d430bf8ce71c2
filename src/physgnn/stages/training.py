"""From a dataset to a trained run with calibrated bounds."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn.dataset import Split, Store, named_split
from physgnn.dataset.split_meshes import split_meshes
from physgnn.errors import InputError
from physgnn.progress import Progress

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.checkpoint import Checkpoint
    from physgnn.learning.training_config import TrainingConfig


def train(
    stores: str | Path | Sequence[str | Path],
    split: str | None,
    config: "TrainingConfig",
    run: str | Path,
    *,
    start: str | Path | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> "Checkpoint":
    """Train on a split of a dataset, or on several, and calibrate the error bounds.

    Parameters
    ----------
    stores, run : paths
        The dataset, or one dataset a patient, and the folder to train into.
    split : str or None
        A row of ``SPLITS`` for one dataset; of several ``mesh``: whole patients are
        held out. By default ``path`` or ``mesh``.
    config : TrainingConfig
        How to train.
    start : path, optional
        A run to begin with the weights of; model and options are then its own, unless
        the configuration gives options.
    progress, **options
        See `physgnn.learning.train`.
    """
    from physgnn.learning.checkpoint import Checkpoint
    from physgnn.learning.training import is_first_process
    from physgnn.learning.training import train as train_model
    from physgnn.prediction.run_calibration import calibrate_family, calibrate_run

    if start is not None:
        options["start"] = begun = Checkpoint.load(start)
        config = _as_begun(config, begun)
    paths = [stores] if isinstance(stores, str | Path) else list(stores)
    # Training keeps what it read in a file: the store needn't keep it too.
    opened = [Store.open(path, cache_bytes=128 * 2**20) for path in paths]
    parts = _splits(split, opened)
    checkpoint = train_model(opened, parts, config, run, progress=progress, **options)
    if is_first_process():
        if len(opened) == 1:
            calibrate_run(run, opened[0], parts[0], progress=progress)
        else:
            calibrate_family(run, opened, parts, progress=progress)
    return checkpoint


def _splits(name: str | None, stores: Sequence[Store]) -> list[Split]:
    if len(stores) == 1:
        return [named_split(name or "path", stores[0])]
    if name not in (None, "mesh"):
        raise InputError(f"several datasets have split mesh only (got {name})")
    return split_meshes(stores)


def _as_begun(config: "TrainingConfig", begun: "Checkpoint") -> "TrainingConfig":
    """Return a configuration whose model is that of a run to begin with."""
    earlier = begun.record["config"]
    options = {**earlier["options"], **config.options}
    return replace(config, model=earlier["model"], options=options)


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
