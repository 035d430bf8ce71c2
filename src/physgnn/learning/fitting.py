"""A run of a model that has no weights to train: fitted, judged and saved."""

from collections.abc import Sequence
from pathlib import Path

import torch

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.learning.budget import Budget
from physgnn.learning.checkpoint import Checkpoint
from physgnn.learning.interface import Body, Model
from physgnn.learning.losses import LOSSES
from physgnn.learning.model_card import write_model_card
from physgnn.learning.models import build_model
from physgnn.learning.run_folder import RunFolder
from physgnn.learning.run_record import new_record, with_result
from physgnn.learning.training_config import TrainingConfig
from physgnn.progress import Progress

JUDGED_ON = 100  # validation samples; they decide nothing


def fit(
    stores: Sequence[Store],
    splits: Sequence[Split],
    config: TrainingConfig,
    run: str | Path,
    *,
    progress: Progress | None = None,
) -> Checkpoint:
    """Fit a model of `models.FITTED` to the training samples and save the run.

    Parameters
    ----------
    stores, splits, config, run, progress
        As of `physgnn.learning.training.train`, but for one dataset only; of the
        configuration model, options and loss count.

    Raises
    ------
    InputError
        If there are several datasets, or the folder holds a run already.
    """
    if len(stores) > 1:
        raise InputError(
            f"model '{config.model}' belongs to one body: give one dataset "
            f"(got {len(stores)})"
        )
    store, split, run = stores[0], splits[0], Path(run)
    if RunFolder(run).record.exists():
        raise InputError(f"{run} holds a run already: name another folder")
    run.mkdir(parents=True, exist_ok=True)
    budget = Budget(config)
    model = build_model(config.model, Body.of(store), **config.options)
    model.fit(store, split.train)
    spent = budget.spent
    loss = _mean_loss(model, store, split, config.loss, progress)
    record = with_result(new_record(store, split, config), loss=loss, spent=spent)
    Checkpoint(model, record).save(run)
    write_model_card(run)
    return Checkpoint.load(run)


@torch.inference_mode()
def _mean_loss(
    model: Model, store: Store, split: Split, loss: str, progress: Progress | None
) -> float:
    """Return the mean loss over some validation samples."""
    every = max(len(split.validation) // JUDGED_ON, 1)
    total, samples = 0.0, split.validation[::every].tolist()
    for done, (path, level) in enumerate(samples):
        inputs = model.encode(store.load_case(path, level))[None]
        true = torch.tensor(store.displacement(path)[level])[None]
        total += float(LOSSES[loss](model(inputs, model.body.graph), true))
        if progress is not None:
            progress(done + 1, len(samples), "judging")
    return total / len(samples)
