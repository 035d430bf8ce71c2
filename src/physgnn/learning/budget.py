"""How much training may cost."""

import math
import time
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer

from physgnn.learning.training_config import TrainingConfig


class Budget(Callback):
    """Counts minutes, resumes included; stops when they're spent.

    Parameters
    ----------
    config : TrainingConfig
        Its ``max_epochs`` and ``max_minutes``.
    """

    def __init__(self, config: TrainingConfig) -> None:
        self.config = config
        self._before = 0.0
        self._start = time.monotonic()

    @property
    def minutes(self) -> float:
        """Minutes of training so far."""
        return self._before + (time.monotonic() - self._start) / 60

    def fraction(self, trainer: Trainer) -> float:
        """Return the part of the budget spent, whichever of its limits is nearer."""
        batches = max(int(trainer.num_training_batches), 1)
        epochs = trainer.global_step / batches / self.config.max_epochs
        minutes = self.minutes / (self.config.max_minutes or math.inf)
        return min(max(epochs, minutes), 1.0)

    def on_fit_start(self, trainer: Trainer, _: LightningModule) -> None:  # noqa: ARG002
        """Start the clock."""
        self._start = time.monotonic()

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        """Stop when the minutes are spent; the epoch still ends with a validation."""
        if self.config.max_minutes:
            spent = self.minutes >= self.config.max_minutes
            # All processes stop together, or one would wait for ever.
            if trainer.strategy.reduce_boolean_decision(spent, all=False):
                trainer.should_stop = True

    def state_dict(self) -> dict[str, Any]:
        """Return the minutes spent."""
        return {"minutes": self.minutes}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Count on from the minutes spent before a resume."""
        self._before = state_dict["minutes"]
