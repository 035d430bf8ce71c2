"""All that decides how a run is trained, checked when it's made."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from physgnn import choices
from physgnn.errors import InputError
from physgnn.learning.models import MODELS, is_model, method_name, method_options

LARGEST_SEED = 2**32 - 1


@dataclass(frozen=True)
class TrainingConfig:
    """How to train; the defaults are the published values (dataset 2).

    `physgnn.config.read_training`, and so the command, takes another model by default.

    Parameters
    ----------
    model : str
        A row of ``MODELS``, by its present or its earlier name, or ``module:Class``.
    options : mapping
        The method's own options, by present or earlier names, such as
        ``{"configuration": 3, "dataset": 2}``.
    loss : str
        A row of ``LOSSES``.
    batch_size : int
        Samples a step (published: 4 on dataset 1, 8 on dataset 2).
    learning_rate : float
        AdamW's, at the start.
    weight_decay : float
        AdamW's.
    schedule : {"plateau", "cosine"}
        ``plateau`` (published): multiply the learning rate by ``plateau_factor`` after
        ``plateau_patience`` epochs without improvement; ``cosine``: let it fall to
        ``minimum_learning_rate`` over the budget, for runs too short for plateaus.
    plateau_patience, plateau_factor, minimum_learning_rate
        See ``schedule``.
    early_stopping : int
        Stop after so many epochs without improvement.
    max_epochs : int
        Stop after so many epochs.
    max_minutes : float or None
        Stop after so many minutes, those before a resume included.
    clock : {"wall", "processor"}
        What counts them; processor time is that of all threads, and does not depend on
        what else the machine does.
    memory_mb : float
        What a step may take. A batch that doesn't fit is computed in parts, and what
        can be is computed twice: the result is the same, at up to 1.5 times the cost.
    precision : {"float32", "bfloat16"}
        Of a PhysGNN's largest products; weights and all else are float32.
    point_fraction : float
        Take the loss at this part of the points, drawn anew for every step. A mean over
        them is an unbiased estimate of that over all, and so is its gradient. A
        PhysGNN's step takes two thirds of the time at a third of the points; other
        models gain nothing. Validation is on all points.
    seed : int
        Of the weights, the order of samples, and dropout; at most 2³² − 1, as
        scikit-learn takes it.

    Raises
    ------
    InputError
        If a value is unknown or out of range.
    """

    model: str = "physgnn"
    options: Mapping[str, Any] = field(default_factory=dict)
    loss: str = "mean_euclidean"
    batch_size: int = 8
    learning_rate: float = 0.005
    weight_decay: float = 0.01
    schedule: str = "plateau"
    plateau_patience: int = 5
    plateau_factor: float = 0.1
    minimum_learning_rate: float = 1e-8
    early_stopping: int = 15
    max_epochs: int = 1000
    max_minutes: float | None = None
    clock: str = "wall"
    memory_mb: float = 768.0
    precision: str = "float32"
    point_fraction: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not is_model(self.model):
            raise InputError(
                f"model must be one of {', '.join(MODELS)}, or module:Class of your "
                f"own (got {self.model})"
            )
        options = method_options(self.model, self.options)
        object.__setattr__(self, "options", options)
        object.__setattr__(self, "model", method_name(self.model))
        for name, choice in (
            ("loss", "LossName"), ("schedule", "Schedule"),
            ("precision", "PrecisionName"), ("clock", "Clock"),
        ):  # fmt: skip
            allowed = choices.names(choice)
            if getattr(self, name) not in allowed:
                raise InputError(
                    f"{name} must be one of {', '.join(allowed)} "
                    f"(got {getattr(self, name)})"
                )
            # Plain text, not an enum's member: checkpoints hold no classes of ours.
            object.__setattr__(self, name, str(getattr(self, name)))
        for name in (
            "batch_size", "learning_rate", "early_stopping", "max_epochs", "memory_mb"
        ):  # fmt: skip
            if not 0 < getattr(self, name) < math.inf:
                raise InputError(f"{name} must be > 0 (got {getattr(self, name)})")
        for name in (
            "weight_decay", "plateau_patience", "minimum_learning_rate", "seed"
        ):  # fmt: skip
            if not 0 <= getattr(self, name) < math.inf:
                raise InputError(f"{name} must be ≥ 0 (got {getattr(self, name)})")
        if self.seed > LARGEST_SEED:
            raise InputError(f"seed must be ≤ {LARGEST_SEED} (got {self.seed})")
        if not 0 < self.point_fraction <= 1:
            raise InputError(
                f"point_fraction must be in (0, 1] (got {self.point_fraction})"
            )
        if not 0 < self.plateau_factor < 1:
            raise InputError(
                f"plateau_factor must be in (0, 1) (got {self.plateau_factor})"
            )
        if self.max_minutes is not None and not self.max_minutes > 0:
            raise InputError(f"max_minutes must be > 0 (got {self.max_minutes})")
