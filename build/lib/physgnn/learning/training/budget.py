"""How much training may cost."""

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from lightning.pytorch import Callback, Trainer

from physgnn.learning.training.config import TrainingConfig

CLOCKS: Mapping[str, Callable[[], float]] = {
    "wall": time.monotonic,
    "processor": time.process_time,  # of all threads
}
"""What can be counted, in seconds."""


class Budget(Callback):
    """Counts minutes by every clock from when it's made; stops when they're spent.

    Those before a resume count too.

    Parameters
    ----------
    config : TrainingConfig
        Its ``max_epochs``, ``max_minutes`` and the ``clock`` these are counted by.
    """

    def __init__(self, config: TrainingConfig) -> None:
        self.config = config
        self._before = dict.fromkeys(CLOCKS, 0.0)
        self._start = _now()

    @property
    def spent(self) -> dict[str, float]:
        """Minutes of training so far, by every clock."""
        now = _now()
        return {
            name: self._before[name] + (now[name] - self._start[name]) / 60
            for name in CLOCKS
        }

    @property
    def minutes(self) -> float:
        """Minutes of training so far, by the clock that ends it."""
        return self.spent[self.config.clock]

    @property
    def is_spent(self) -> bool:
        """Whether the minutes are spent."""
        return bool(self.config.max_minutes) and self.minutes >= (
            self.config.max_minutes or math.inf
        )

    def fraction(self, trainer: Trainer) -> float:
        """Return the part of the budget spent, whichever of its limits is nearer."""
        batches = max(int(trainer.num_training_batches), 1)
        epochs = trainer.global_step / batches / self.config.max_epochs
        minutes = self.minutes / (self.config.max_minutes or math.inf)
        return min(max(epochs, minutes), 1.0)

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        """Stop when the minutes are spent; the epoch still ends with a validation."""
        # All processes stop together, or one would wait for ever.
        if self.config.max_minutes and trainer.strategy.reduce_boolean_decision(
            self.is_spent, all=False
        ):
            trainer.should_stop = True

    def state_dict(self) -> dict[str, Any]:
        """Return the minutes spent."""
        return self.spent

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Count on from the minutes spent before a resume."""
        self._before = {name: state_dict[name] for name in CLOCKS}


def _now() -> dict[str, float]:
    return {name: read() for name, read in CLOCKS.items()}
