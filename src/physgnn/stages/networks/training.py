"""From a dataset to a trained run with calibrated bounds."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn.config import read_training
from physgnn.dataset import Split, Store, named_split
from physgnn.dataset.label_balance import in_balance
from physgnn.dataset.splits.meshes import split_meshes
from physgnn.errors import InputError
from physgnn.progress import Progress
from physgnn.stages.outputs import Output, writes

if TYPE_CHECKING:  # torch takes seconds to import: only the functions that need it do
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.training.config import TrainingConfig


@writes(out=Output(is_folder=True, inside=("start",)))
def train(
    store: str | Path | Sequence[str | Path],
    out: str | Path,
    *,
    config: str | Path | None = None,
    model: str | None = None,
    configuration: int | None = None,
    split: str | None = None,
    start: str | Path | None = None,
    loss: str | None = None,
    batch_size: int | None = None,
    learning_rate: float | None = None,
    max_epochs: int | None = None,
    max_minutes: float | None = None,
    memory_mb: float | None = None,
    precision: str | None = None,
    seed: int | None = None,
    device: str = "cpu",
    devices: int = 1,
    num_nodes: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
) -> "Checkpoint":
    """Train a network on a dataset, or on several, and calibrate its error bounds.

    Parameters
    ----------
    store : path or sequence of paths
        Dataset made by `simulate`, or one dataset a patient.
    out : path
        Folder to train into.
    config : path, optional
        TOML with training settings, see `physgnn.config.training`; those given here
        win over the file's.
    model : str, optional
        A row of ``MODELS``; by default the lifted network, or the published one if one
        of its options is given. To resume, by default that of the run.
    loss, batch_size, learning_rate, max_epochs, max_minutes, memory_mb, precision, \
seed
        Fields of `physgnn.learning.training.config.TrainingConfig`.
    configuration : int, optional
        1 to 12, of the published network.
    split : str, optional
        A row of ``SPLITS``, by default ``path``; of several datasets ``mesh``.
    start : path, optional
        A run to begin with the weights of; model and options are then its own, unless
        the configuration gives options.
    device, devices, num_nodes
        Where to train: see `physgnn.learning.training.devices.Machine`.
    resume : bool
        Continue an interrupted run.
    progress : callable, optional
        Called with the part of the budget spent, in thousandths.

    Returns
    -------
    Checkpoint
        The best model.

    Raises
    ------
    InputError
        If a file or setting cannot be used, or the folder holds a run already.
    """
    from physgnn.learning.training.devices import Machine

    options = {} if configuration is None else {"configuration": configuration}
    of_steps: dict[str, Any] = {
        "loss": loss,
        "batch_size": batch_size,
        "learning_rate": learning_rate,
        "max_epochs": max_epochs,
        "memory_mb": memory_mb,
        "precision": precision,
    }
    earlier = _model_of_run(Path(out) if resume else start)
    settings = read_training(
        config,
        **earlier,
        model=model,
        max_minutes=max_minutes,
        seed=seed,
        options=options,
        **of_steps,
    )
    if start is not None and settings.model != earlier.get("default_model"):
        _check_begun(Path(start), settings.model)
    machine = {
        "device": None if device == "cpu" else device,
        "devices": None if devices == 1 else devices,
        "num_nodes": None if num_nodes == 1 else num_nodes,
    }
    _check_used(settings.model, {**of_steps, **machine})
    return train_run(
        store,
        split,
        settings,
        out,
        start=start,
        progress=progress,
        machine=Machine(device, devices, num_nodes),
        resume=resume,
    )


def _check_used(model: str, of_steps: Mapping[str, object]) -> None:
    """Raise InputError if settings of a training by steps are given for another."""
    from physgnn.learning.models import model_class
    from physgnn.learning.network import Network

    given = [name for name, value in of_steps.items() if value is not None]
    if given and not issubclass(model_class(model), Network):
        options = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise InputError(
            f"model '{model}' is not trained by steps: leave {options} out"
        )


def _check_begun(start: Path, model: str) -> None:
    """Raise InputError if a run to begin with is not of the model that is named."""
    begun = _model_of_run(start).get("default_model", model)
    if begun != model:
        raise InputError(
            f"{start} is of model '{begun}', not of '{model}': a training begins with "
            "weights of its own model; leave one of the two out"
        )


def _model_of_run(run: str | Path | None) -> dict[str, Any]:
    """Return what is trained if nothing else is said: the model of an earlier run."""
    from physgnn.learning.runs.folder import RunFolder
    from physgnn.learning.runs.record import read_json

    record = None if run is None else RunFolder(Path(run)).record
    if record is None or not record.is_file():
        return {}  # training says what is missing
    return {"default_model": read_json(record)["config"]["model"]}


def train_run(
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
        See `physgnn.learning.training.training_run.train`.
    """
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.training.training_run import is_first_process
    from physgnn.learning.training.training_run import train as train_model
    from physgnn.prediction.error_bounds.run_calibration import (
        calibrate_family,
        calibrate_run,
    )

    asked = config.options
    if start is not None:
        options["start"] = begun = Checkpoint.load(start)
        config = _as_begun(config, begun)
    paths = [stores] if isinstance(stores, str | Path) else list(stores)
    # Training keeps what it read in a file: the store needn't keep it too.
    opened = [Store.open(path, cache_bytes=128 * 2**20) for path in paths]
    parts = _splits(split, opened)
    config = _as_labels_are(config, asked, opened)
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


def _as_labels_are(
    config: "TrainingConfig", asked: Mapping[str, Any], stores: Sequence[Store]
) -> "TrainingConfig":
    """Leave out steps to an equilibrium that labels are not in, unless asked for."""
    from physgnn.learning.models import OTHER_LABELS

    off = {
        name: value
        for name, value in OTHER_LABELS.get(config.model, {}).items()
        if name not in asked
    }
    if not off or all(in_balance(store) for store in stores):
        return config
    settings = ", ".join(f"{name} = {value}" for name, value in off.items())
    logging.getLogger(__name__).warning(
        "the displacements to learn from are no equilibria of the mesh's elements: "
        "steps to such are left out (%s)",
        settings,
    )
    return replace(config, options={**config.options, **off})


def _as_begun(config: "TrainingConfig", begun: "Checkpoint") -> "TrainingConfig":
    """Return a configuration whose model is that of a run to begin with."""
    earlier = begun.record["config"]
    options = {**earlier["options"], **config.options}
    return replace(config, model=earlier["model"], options=options)
