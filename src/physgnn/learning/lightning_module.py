"""A model as Lightning trains it: the loss and the optimiser."""

from typing import Any

import torch
from lightning.pytorch import LightningModule
from torch import Tensor

from physgnn.errors import InputError
from physgnn.learning.batches import Batch
from physgnn.learning.interface import Model
from physgnn.learning.losses import LOSSES
from physgnn.learning.training_config import TrainingConfig

VALIDATION_LOSS = "validation_loss"
TRAINING_LOSS = "training_loss"


class TrainingModule(LightningModule):
    """Trains any :class:`Model` as a :class:`TrainingConfig` says."""

    def __init__(self, model: Model, config: TrainingConfig) -> None:
        super().__init__()
        self.model = model
        self.config = config
        self.loss = LOSSES[config.loss]
        self.graph = model.body.graph

    def on_fit_start(self) -> None:
        """Move the graph to where the weights are."""
        self.graph = self.model.body.graph.to(self.device)

    def on_train_batch_start(self, *_: Any) -> None:
        """Let dropout follow from seed and step alone, so that a resume repeats it."""
        torch.manual_seed(self.config.seed + 1_000_003 * (1 + self.global_step))

    def training_step(self, batch: Batch, _: int) -> Tensor:
        """Return the batch's loss; InputError if it isn't finite."""
        loss = self._loss(batch)
        if not torch.isfinite(loss):
            raise InputError(
                f"the training loss became {loss.item()} in epoch "
                f"{self.current_epoch}; lower learning_rate "
                f"({self.config.learning_rate:g}). The best weights of the epochs "
                "before it, if any, are kept in the run folder"
            )
        self._log(TRAINING_LOSS, loss, batch)
        return loss

    def validation_step(self, batch: Batch, _: int) -> None:
        """Record the batch's loss."""
        self._log(VALIDATION_LOSS, self._loss(batch), batch)

    def configure_optimizers(self) -> torch.optim.Optimizer:
        """Return AdamW, as published."""
        return torch.optim.AdamW(
            self.parameters(),
            lr=self.config.learning_rate,
            weight_decay=self.config.weight_decay,
        )

    def _loss(self, batch: Batch) -> Tensor:
        inputs, true = batch
        return self.loss(self.model(inputs, self.graph), true)

    def _log(self, name: str, loss: Tensor, batch: Batch) -> None:
        size = len(batch[0])
        self.log(name, loss, on_step=False, on_epoch=True, batch_size=size)
