"""A model as Lightning trains it: the loss, the gradient in parts, the optimiser."""

from collections.abc import Sequence

import torch
from lightning.pytorch import LightningModule
from torch import Tensor

from physgnn.errors import InputError
from physgnn.learning.graph import graph_of
from physgnn.learning.network import Network
from physgnn.learning.physgnn.layers.dropout import seed_dropout
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.objective.losses import LOSSES
from physgnn.learning.training.samples.multi_mesh import MeshBatch as Batch

VALIDATION_LOSS = "validation_loss"
TRAINING_LOSS = "training_loss"


class TrainingModule(LightningModule):
    """Trains any :class:`Network` as a :class:`TrainingConfig` says.

    Parameters
    ----------
    models : sequence of Network
        What to train: one a body, all of the same weights.
    config : TrainingConfig
        How.
    at_once : int
        Samples to compute at once; gradients are those of the whole batch, to rounding.
    """

    def __init__(
        self, models: Sequence[Network], config: TrainingConfig, at_once: int
    ) -> None:
        super().__init__()
        self.automatic_optimization = False  # Lightning can't add up unequal parts
        self.model = models[0]
        self.networks = tuple(models)
        self.config = config
        self.at_once = at_once
        self.loss = LOSSES[config.loss]
        self.graphs = tuple(graph_of(model.body) for model in models)

    def on_fit_start(self) -> None:
        """Move the graphs, and what belongs to one body, to where the weights are."""
        self._follow()

    def on_validation_start(self) -> None:
        """Do so before a validation that no training goes before."""
        self._follow()

    def _follow(self) -> None:
        self.graphs = tuple(graph.to(self.device) for graph in self.graphs)
        for model in self.networks:
            model.to(self.device)

    def training_step(self, batch: Batch, _: int) -> Tensor:
        """Step; return the batch's loss; InputError if it isn't finite."""
        optimiser = self.optimizers()
        assert not isinstance(optimiser, list)
        optimiser.zero_grad()
        seeds, weight = self._seeds(len(batch[0])), self._weight(len(batch[0]))
        points = self._points(int(batch[2][0]))
        total = torch.zeros((), device=self.device)
        for first in range(0, len(batch[0]), self.at_once):
            part = slice(first, first + self.at_once)
            seed_dropout(self.model, seeds[part])
            loss = self._loss(batch, part, points)
            share = len(seeds[part]) / len(seeds)
            self._check(loss)
            self.manual_backward(loss * share * weight)
            total += share * loss.detach()
        optimiser.step()
        self._log(TRAINING_LOSS, total, batch)
        return total

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

    def _seeds(self, n_samples: int) -> list[int]:
        """Return a seed for every sample: from run, step and place in the batch."""
        step = self._step_seed
        rank, processes = self.trainer.global_rank, self.trainer.world_size
        return [1009 * step + rank + processes * k for k in range(n_samples)]

    def _weight(self, n_samples: int) -> float:
        """Return this process's part of the batch over its part of the mean of all."""
        mine = torch.tensor(float(n_samples), device=self.device)
        mean = self.trainer.strategy.reduce(mine.clone(), reduce_op="mean")
        return float(mine / mean)

    def _check(self, loss: Tensor) -> None:
        if not torch.isfinite(loss):
            raise InputError(
                f"the training loss became {loss.item()} in epoch "
                f"{self.current_epoch}; lower learning_rate "
                f"({self.config.learning_rate:g}). The best weights of the epochs "
                "before it, if any, are kept in the run folder"
            )

    def _points(self, mesh: int) -> Tensor | None:
        """Draw the points of this step, the same in all processes; None for all."""
        fraction, n_points = self.config.point_fraction, self.graphs[mesh].n_points
        if fraction == 1.0:
            return None
        random = torch.Generator().manual_seed(self._step_seed)
        drawn = torch.randperm(n_points, generator=random)
        return drawn[: max(round(fraction * n_points), 1)].to(self.device)

    @property
    def _step_seed(self) -> int:
        return self.config.seed + 1_000_003 * (1 + self.global_step)

    def _loss(
        self,
        batch: Batch,
        part: slice = slice(None),
        points: Tensor | None = None,
    ) -> Tensor:
        inputs, true, mesh = batch
        k = int(mesh[0])
        network, graph = self.networks[k], self.graphs[k]
        if points is None:
            return self.loss(network(inputs[part], graph), true[part])
        predicted = network.at_points(inputs[part], graph, points)
        return self.loss(predicted, true[part][:, points])

    def _log(self, name: str, loss: Tensor, batch: Batch) -> None:
        size = len(batch[0])
        self.log(
            name, loss, on_step=False, on_epoch=True, batch_size=size, sync_dist=True
        )
