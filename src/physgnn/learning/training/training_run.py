"""Training: a store and a split in, a run folder with the best weights out."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
import torch.distributed as dist
from lightning.pytorch import Callback
from torch import Tensor
from torch.utils.data import default_collate

from physgnn.dataset import Split, Store
from physgnn.errors import InputError
from physgnn.learning.cpu import only_side_by_side
from physgnn.learning.graph import graph_of
from physgnn.learning.models import build_model, model_class
from physgnn.learning.network import Network
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.model_card import write_model_card
from physgnn.learning.runs.record import (
    check_same_run,
    new_record,
    with_places,
    with_result,
    with_start,
)
from physgnn.learning.surrogate import Surrogate
from physgnn.learning.training.budget import Budget
from physgnn.learning.training.callbacks import KeepBest, MetricsFile, ProgressReport
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.devices import Machine, make_trainer, quiet
from physgnn.learning.training.lightning_module import TrainingModule
from physgnn.learning.training.objective.losses import LOSSES
from physgnn.learning.training.resumption.interruption import (
    ending_at_signals,
    ending_together,
)
from physgnn.learning.training.resumption.random_states import seeded
from physgnn.learning.training.resumption.resuming import find_state, prepare
from physgnn.learning.training.samples.batches import Samples, Share
from physgnn.learning.training.samples.memory import samples_at_once
from physgnn.learning.training.samples.multi_mesh import (
    Splits,
    Stores,
    TrainingMesh,
    build_models,
    fitted_samples,
    training_batches,
    training_meshes,
    validation_batches,
)
from physgnn.learning.training.samples.sample_cache import SampleCache
from physgnn.learning.training.schedules import SCHEDULES
from physgnn.progress import Progress

JUDGED_ON = 100  # validation samples, of what is fitted in one go; they decide nothing
ONE_PROCESS = Machine()


def train(
    store: Stores,
    split: Splits,
    config: TrainingConfig,
    run: str | Path,
    *,
    progress: Progress | None = None,
    machine: Machine = ONE_PROCESS,
    resume: bool = False,
    start: Checkpoint | None = None,
) -> Checkpoint:
    """Train a model on the training part of a split, and save the run.

    A network is trained step by step, and its weights with the lowest validation loss
    are kept, those it begins with among them if it is useful untrained. Every other
    surrogate is fitted in one go, and of the configuration model, options, loss and
    seed count.

    Parameters
    ----------
    store : Store or sequence of Store
        The dataset, read lazily; or several, each of another body, for a model that
        can learn from many. The run is then that of the first body.
    split : Split or sequence of Split
        One a dataset. Training and validation samples are used, never test samples.
    config : TrainingConfig
        How to train.
    run : path
        Folder for weights, record, mesh, metrics; every epoch leaves it usable.
    progress : callable, optional
        Called with the part of the budget spent, in thousandths.
    machine : Machine
        Where to compute, in how many processes.
    resume : bool
        Continue from the last state, which is at most five minutes older than the
        interruption, or from the beginning if there was none yet. On one machine, with
        the same number of threads and a budget of epochs, the weights are, bit for bit,
        those of a run never interrupted.
    start : Checkpoint, optional
        Begin with its weights, of whatever body; both models must be able to share.

    Returns
    -------
    Checkpoint
        The best model.

    Raises
    ------
    InputError
        If the folder holds a run already (or, to resume, none, or another), or the
        loss becomes NaN, or a sample needs more memory than allowed.
    """
    run = Path(run)
    meshes = training_meshes(store, split)
    record = new_record(meshes, asdict(config))
    record = with_places(record, run, [mesh.store for mesh in meshes])
    if not issubclass(model_class(config.model), Network):
        if len(meshes) > 1 or start is not None:
            raise InputError(
                f"model '{config.model}' is fitted to one body in one go: give one "
                "dataset, and no run to begin with"
            )
        if resume:
            check_same_run(run, record, asdict(TrainingConfig()))
        else:
            prepare(run, record)
        return _fitted(meshes[0], config, run, record, progress)
    if start is not None:
        record = with_start(record, start.record)
    state = None
    if resume:
        state = find_state(run, record)
    else:
        prepare(run, record)
    budget = Budget(config)
    with ExitStack() as stack:
        stack.enter_context(ending_at_signals())
        stack.enter_context(_seeded(config.seed))
        models = build_models(meshes, config, start.model if start else None)
        for model in models:
            model.set_precision(config.precision)
        caches = [stack.enter_context(SampleCache(run)) for _ in models]
        samples, held_out = fitted_samples(meshes, models, caches, config.seed)
        best = KeepBest(lambda: Checkpoint(models[0], so_far()).save(run))

        def so_far() -> dict[str, Any]:
            return with_result(
                record, loss=best.loss, spent=budget.spent, epoch=best.epoch
            )

        callbacks = [best, *_watchers(run, config, budget, progress)]
        trainer = make_trainer(run, budget, callbacks, machine)
        share = Share(trainer.global_rank, trainer.world_size)
        at_once = _at_once(samples, config)
        stack.enter_context(only_side_by_side())
        stack.enter_context(ending_together(trainer))
        module = TrainingModule(models, config, at_once)
        validation = validation_batches(held_out, at_once, share)
        if state is None and (models[0].useful_untrained or start is not None):
            trainer.validate(module, validation, verbose=False)
        trainer.fit(
            module,
            training_batches(samples, config.batch_size, config.seed, share),
            validation,
            ckpt_path=state,
            weights_only=True,
        )
    if trainer.is_global_zero:
        _finish(run, so_far())
    trainer.strategy.barrier()
    return Checkpoint.load(run)


def _fitted(
    mesh: TrainingMesh,
    config: TrainingConfig,
    run: Path,
    record: dict[str, Any],
    progress: Progress | None,
) -> Checkpoint:
    """Fit a surrogate in one go, judge it on some validation samples, save the run."""
    store, split = mesh
    budget = Budget(config)
    model = build_model(config.model, store.body, **config.options)
    model.fit(store, split.train, config.seed)
    spent = budget.spent
    loss = judged(model, store, split, config.loss, progress)
    Checkpoint(model, with_result(record, loss=loss, spent=spent)).save(run)
    write_model_card(run)
    return Checkpoint.load(run)


def judged(
    model: Surrogate,
    store: Store,
    split: Split,
    loss: str,
    progress: Progress | None = None,
) -> float:
    """Return the mean loss, a row of ``LOSSES``, on some validation samples.

    Those decide nothing: `JUDGED_ON` of them, evenly spread.
    """
    every = max(len(split.validation) // JUDGED_ON, 1)
    losses, samples = [], split.validation[::every].tolist()
    for path, level in samples:
        predicted = torch.tensor(model.predict(model.sample_case(store, path, level)))
        true = torch.tensor(store.displacement(path)[level])
        losses.append(float(LOSSES[loss](predicted.float()[None], true[None])))
        if progress is not None:
            progress(len(losses), len(samples), "judging")
    return sum(losses) / max(len(losses), 1)


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Draw random numbers from a seed, without trace in the caller's, and in quiet."""
    with quiet(), seeded(seed):
        yield


def _finish(run: Path, record: dict[str, Any]) -> None:
    Checkpoint(Checkpoint.load(run).model, record).save(run)
    write_model_card(run)


def is_first_process() -> bool:
    """Return whether this is the one process, or the first of those that train."""
    return not (dist.is_available() and dist.is_initialized()) or dist.get_rank() == 0


def _at_once(parts: Sequence[Samples], config: TrainingConfig) -> int:
    """Return how many samples to compute at once; the first of the largest body try."""
    samples = max(
        (part for part in parts if len(part)), key=lambda p: p.model.body.mesh.n_points
    )
    model, loss = samples.model, LOSSES[config.loss]

    def forward(n_samples: int) -> Tensor:
        inputs, true = default_collate([samples[i] for i in range(n_samples)])
        return loss(model(inputs, graph_of(model.body)), true)

    n = min(config.batch_size, len(samples))
    return samples_at_once(model, forward, batch_size=n, limit_mb=config.memory_mb)


def _watchers(
    run: Path, config: TrainingConfig, budget: Budget, progress: Progress | None
) -> list[Callback]:
    """Return what follows the epochs: the learning rate, the records, the bar."""
    schedule = SCHEDULES[config.schedule](config, budget)
    file = MetricsFile(RunFolder(run).metrics, budget)
    return [schedule, file, *([ProgressReport(progress, budget)] if progress else [])]
