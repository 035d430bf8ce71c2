"""How the learning rate falls: one callback a schedule, its state in the checkpoint."""

import math
from collections.abc import Mapping
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer
from torch.optim.lr_scheduler import ReduceLROnPlateau

from physgnn.learning.training.budget import Budget
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.lightning_module import VALIDATION_LOSS


class Plateau(Callback):
    """As published: lower the rate when the validation loss stops falling.

    Stepped here, not by Lightning, which saves its checkpoint of an epoch before the
    epoch's validation loss has reached the schedule.
    """

    def __init__(self, config: TrainingConfig, budget: Budget) -> None:  # noqa: ARG002
        self.config = config
        self._state: dict[str, Any] | None = None
        self._scheduler: ReduceLROnPlateau | None = None

    def on_train_start(self, trainer: Trainer, _: LightningModule) -> None:
        """Attach to the optimiser."""
        self._scheduler = ReduceLROnPlateau(
            trainer.optimizers[0],
            factor=self.config.plateau_factor,
            patience=self.config.plateau_patience,
            min_lr=self.config.minimum_learning_rate,
        )
        if self._state:
            self._scheduler.load_state_dict(self._state)

    def on_train_epoch_end(self, trainer: Trainer, _: LightningModule) -> None:
        """Show it the epoch's validation loss."""
        assert self._scheduler is not None
        self._scheduler.step(float(trainer.callback_metrics[VALIDATION_LOSS]))

    def state_dict(self) -> dict[str, Any]:
        """Return how long the loss hasn't fallen."""
        return dict(self._scheduler.state_dict()) if self._scheduler else {}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue where a checkpoint stopped."""
        self._state = state_dict


class Cosine(Callback):
    """Half a cosine wave from the first rate to the lowest over the whole budget."""

    def __init__(self, config: TrainingConfig, budget: Budget) -> None:
        self.low = config.minimum_learning_rate
        self.high = config.learning_rate
        self.budget = budget

    def on_train_batch_start(self, trainer: Trainer, *_: Any) -> None:
        """Set the step's rate."""
        wave = (1 + math.cos(math.pi * self.budget.fraction(trainer))) / 2
        for group in trainer.optimizers[0].param_groups:
            group["lr"] = self.low + (self.high - self.low) * wave


SCHEDULES: Mapping[str, type[Plateau] | type[Cosine]] = {
    "plateau": Plateau,
    "cosine": Cosine,
}
