"""What is stored and reported while training goes on."""

import csv
import io
import math
import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.callbacks import Checkpoint
from lightning.pytorch.trainer.states import TrainerFn

from physgnn.io.integrity.atomic import whole_file, write_whole
from physgnn.learning.training.budget import Budget
from physgnn.learning.training.lightning_module import TRAINING_LOSS, VALIDATION_LOSS
from physgnn.progress import Progress

SECONDS_BETWEEN_STATES = 300.0


class KeepBest(Callback):
    """Calls back whenever the validation loss is the lowest so far.

    Attributes
    ----------
    loss : float
        The lowest.
    epoch : int or None
        After which it was; 0 before the first, None if a record does not say.
    """

    def __init__(self, keep: Callable[[], None]) -> None:
        self.keep = keep
        self.loss = math.inf
        self.epoch: int | None = None

    def on_validation_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Compare, and call back if it is lower."""
        loss = float(trainer.callback_metrics[VALIDATION_LOSS])
        if loss < self.loss:
            self.loss = loss
            alone = trainer.state.fn == TrainerFn.VALIDATING
            self.epoch = 0 if alone else trainer.current_epoch + 1
            if trainer.is_global_zero:
                self.keep()

    def state_dict(self) -> dict[str, Any]:
        """Return the lowest loss, and its epoch."""
        return {"loss": self.loss, "epoch": self.epoch}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue from the lowest loss before a resume."""
        self.loss, self.epoch = state_dict["loss"], state_dict.get("epoch")


class KeepState(Checkpoint):
    """Writes what a resume needs, when an epoch ends and every few minutes within it.

    Lightning's own callback does neither before training ends if only the last state is
    wanted and optimisation is manual. The state is written beside its place: the one
    before stays until it is whole.

    Parameters
    ----------
    file : path
        Its place.
    budget : Budget
        Says whether a training that had ended may go on.
    """

    def __init__(self, file: Path, budget: Budget) -> None:
        self.file = file
        self.budget = budget
        self._last = time.monotonic()
        self._ended = self._ended_by_budget = False

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        """Write if it's time; not where the epoch's validation comes next."""
        late = time.monotonic() - self._last >= SECONDS_BETWEEN_STATES
        if trainer.strategy.reduce_boolean_decision(late, all=False):
            self._last = time.monotonic()
            if not trainer.is_last_batch:
                self._save(trainer)

    def on_train_epoch_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Write; the epoch has been validated."""
        self._ended = bool(trainer.should_stop)
        self._ended_by_budget = self.budget.is_spent
        self._save(trainer)

    def on_train_start(self, trainer: Trainer, _: LightningModule) -> None:
        """Train no further if training had ended, unless its budget has grown."""
        more = self._ended_by_budget and not self.budget.is_spent
        if self._ended and not more:
            trainer.should_stop = True

    def state_dict(self) -> dict[str, Any]:
        """Return whether training has ended, and why."""
        return {"ended": self._ended, "by_budget": self._ended_by_budget}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Take what was so before a resume."""
        self._ended = state_dict.get("ended", False)
        self._ended_by_budget = state_dict.get("by_budget", False)

    def _save(self, trainer: Trainer) -> None:
        first = trainer.is_global_zero
        with whole_file(self.file) if first else nullcontext(self.file) as part:
            trainer.save_checkpoint(part)


class MetricsFile(Callback):
    """One CSV row an epoch; a resume goes on after the last epoch before its state."""

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
        text = io.StringIO()
        writer = csv.DictWriter(text, fieldnames=list(row), extrasaction="ignore")
        writer.writeheader()
        writer.writerows([*self._before(trainer.current_epoch), row])
        write_whole(self.file, text.getvalue())

    def _before(self, epoch: int) -> list[dict[str, str]]:
        """Return the rows of earlier epochs."""
        if not self.file.exists():
            return []
        with self.file.open(newline="", encoding="utf-8") as stream:
            rows = [row for row in csv.DictReader(stream) if row["epoch"].isdigit()]
        return [row for row in rows if int(row["epoch"]) < epoch]


class ProgressReport(Callback):
    """Reports the part of the budget spent, in thousandths, to a progress callback."""

    def __init__(self, progress: Progress, budget: Budget) -> None:
        self.progress = progress
        self.budget = budget

    def on_train_batch_end(
        self, trainer: Trainer, _: LightningModule, outputs: Any, *__: Any
    ) -> None:
        """Report epoch, losses and learning rate."""
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
