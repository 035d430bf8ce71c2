"""What is kept and told while training goes on."""

import csv
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.callbacks import Checkpoint

from physgnn.learning.training.budget import Budget
from physgnn.learning.training.lightning_module import TRAINING_LOSS, VALIDATION_LOSS
from physgnn.progress import Progress

SECONDS_BETWEEN_STATES = 300.0


class KeepBest(Callback):
    """Calls back with the validation loss whenever it's the lowest so far."""

    def __init__(self, keep: Callable[[float], None]) -> None:
        self.keep = keep
        self.loss = math.inf

    def on_validation_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Compare, and keep."""
        loss = float(trainer.callback_metrics[VALIDATION_LOSS])
        if loss < self.loss:
            self.loss = loss
            if trainer.is_global_zero:
                self.keep(loss)

    def state_dict(self) -> dict[str, Any]:
        """Return the lowest loss."""
        return {"loss": self.loss}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue from the lowest loss before a resume."""
        self.loss = state_dict["loss"]


class KeepState(Checkpoint):
    """Writes what a resume needs, when an epoch ends and every few minutes within it.

    Lightning's own callback does neither before training ends if only the last state is
    wanted and optimisation is manual.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        self._last = time.monotonic()

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        """Write if it's time; not where the epoch's validation comes next."""
        late = time.monotonic() - self._last >= SECONDS_BETWEEN_STATES
        if trainer.strategy.reduce_boolean_decision(late, all=False):
            self._last = time.monotonic()
            if not trainer.is_last_batch:
                trainer.save_checkpoint(self.file)

    def on_train_epoch_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Write; the epoch has been validated."""
        trainer.save_checkpoint(self.file)


class MetricsFile(Callback):
    """One CSV row an epoch; a resume adds to what's there."""

    def __init__(self, file: Path, budget: Budget) -> None:
        self.file = file
        self.budget = budget

    def on_train_epoch_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Append the epoch's row."""
        if not trainer.is_global_zero:
            return
        row = {
            "epoch": trainer.current_epoch,
            TRAINING_LOSS: float(trainer.callback_metrics[TRAINING_LOSS]),
            VALIDATION_LOSS: float(trainer.callback_metrics[VALIDATION_LOSS]),
            "learning_rate": trainer.optimizers[0].param_groups[0]["lr"],
            "minutes": round(self.budget.minutes, 4),
        }
        new = not self.file.exists()
        with self.file.open("a", newline="") as stream:
            writer = csv.DictWriter(stream, fieldnames=list(row))
            if new:
                writer.writeheader()
            writer.writerow(row)


class ProgressReport(Callback):
    """Tells a progress callback how much of the budget is spent, in thousandths."""

    def __init__(self, progress: Progress, budget: Budget) -> None:
        self.progress = progress
        self.budget = budget

    def on_train_batch_end(
        self, trainer: Trainer, _: LightningModule, outputs: Any, *__: Any
    ) -> None:
        """Tell epoch, losses and learning rate."""
        if not trainer.is_global_zero:
            return
        loss = float(torch.as_tensor(outputs["loss"]))
        validation = trainer.callback_metrics.get(VALIDATION_LOSS)
        text = f"epoch {trainer.current_epoch} · loss {loss:.4g}"
        if validation is not None:
            text += f" · validation {float(validation):.4g}"
        rate = trainer.optimizers[0].param_groups[0]["lr"]
        done = round(1000 * self.budget.fraction(trainer))
        self.progress(done, 1000, f"{text} · learning rate {rate:.2g}")
