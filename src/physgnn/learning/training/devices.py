"""Lightning's side of training: the processes and machines it uses, its manners."""

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import torch
from lightning.pytorch import Callback, Trainer
from lightning.pytorch.callbacks import EarlyStopping
from lightning.pytorch.loggers import TensorBoardLogger

from physgnn.errors import InputError
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.budget import Budget
from physgnn.learning.training.callbacks import KeepState
from physgnn.learning.training.lightning_module import VALIDATION_LOSS
from physgnn.learning.training.resumption.interruption import SignalsAsBefore
from physgnn.learning.training.resumption.random_states import RandomState


@dataclass(frozen=True)
class Machine:
    """Where to train.

    Parameters
    ----------
    device : str
        As Lightning names it: ``"cpu"``, ``"cuda"``, ``"auto"``.
    devices, num_nodes : int
        Processes on this machine, and machines. They share every batch out; losses and
        weights are those of one process, to rounding. Each process runs the caller's
        program from its start; only the first writes into the run folder.

    Raises
    ------
    InputError
        If there's no process or no machine, or the device isn't there.
    """

    device: str = "cpu"
    devices: int = 1
    num_nodes: int = 1

    def __post_init__(self) -> None:
        if self.devices < 1 or self.num_nodes < 1:
            raise InputError(
                "devices and num_nodes must be 1 or more "
                f"(got {self.devices} and {self.num_nodes})"
            )
        there = {
            "cpu": True,
            "auto": True,
            "cuda": torch.cuda.is_available(),
            "gpu": torch.cuda.is_available() or torch.backends.mps.is_available(),
            "mps": torch.backends.mps.is_available(),
        }
        if not there.get(self.device, False):
            usable = ", ".join(name for name, is_there in there.items() if is_there)
            raise InputError(
                f"device must be one that this machine has: {usable} "
                f"(got '{self.device}')"
            )


def make_trainer(
    run: Path, budget: Budget, callbacks: list[Callback], machine: Machine
) -> Trainer:
    """Return Lightning's trainer, which keeps its state in the run's folder.

    Parameters
    ----------
    run : path
        The folder.
    budget : Budget
        When to stop; its configuration is that of the training.
    callbacks : list
        What else happens meanwhile.
    machine : Machine
        Where to compute.
    """
    config = budget.config
    patience = EarlyStopping(VALIDATION_LOSS, patience=config.early_stopping)
    state = KeepState(RunFolder(run).state, budget)
    common = [budget, *callbacks, RandomState(), SignalsAsBefore(), patience, state]
    return Trainer(
        accelerator=machine.device,
        devices=machine.devices,
        num_nodes=machine.num_nodes,
        strategy="ddp" if machine.devices * machine.num_nodes > 1 else "auto",
        use_distributed_sampler=False,
        max_epochs=config.max_epochs,
        callbacks=common,
        logger=TensorBoardLogger(run, name="tensorboard", version=""),
        default_root_dir=run,
        num_sanity_val_steps=0,
        enable_progress_bar=False,
        enable_model_summary=False,
    )


# Lightning's advice that doesn't apply: samples are made faster than they're used, the
# run folder is meant to hold what an earlier run left, and its own calls are its own.
_NOISE = (
    r".*isinstance\(treespec, LeafSpec\).*",
    ".*does not have many workers.*",
    ".*number of training batches.*is smaller than the logging interval.*",
    ".*Checkpoint directory.*exists and is not empty.*",
)


@contextmanager
def quiet() -> Iterator[None]:
    """Keep Lightning's advice and greetings from the user."""
    logger = logging.getLogger("lightning.pytorch")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            for message in _NOISE:
                warnings.filterwarnings("ignore", message)
            yield
    finally:
        logger.setLevel(level)
