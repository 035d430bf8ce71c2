"""The methods that are compared, their options and how networks are trained."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from physgnn.errors import InputError
from physgnn.learning.models import (
    MODELS,
    is_model,
    model_class,
    resolved_options,
)
from physgnn.learning.network import Network

REPAIRED, REPAIRS = "repaired", "lifted"  # the row, and whose displacements it repairs
TOLERANCE_MM = 0.1
TRIVIAL = ("zero", "linear")  # always measured beside whatever else is
SOLVERS = ("finite-element",)  # gives the truth: not compared with it
SHIFTS_ONLY = ("rigid", "spline", "register")  # take what was measured, not a load
SURFACE_NETWORK = "cnn"  # takes the displacement of a surface
CHEAP = (
    "zero", "linear", "interpolation", "linear-regression", "decision-tree",
    "random-forest", "extra-trees", "svr", "gpr", "mlp", "pod-network", "rbf",
)  # fmt: skip
SMALL: Mapping[str, Mapping[str, Any]] = {
    "pod-network": {"width": 16, "epochs": 20},
    "extra-trees": {"trees": 4},
    "mlp": {"width": 16, "epochs": 4},
    "meshgraphnet": {"width": 16, "steps": 3},
    "transolver": {"width": 16, "layers": 2, "heads": 2, "slices": 8},
    "cnn": {"cells": 16, "width": 8, "levels": 2},
    "physgnn": {"width": 16},
    "lifted": {"width": 16, "layers": 2, "response_modes": 16},
    "galerkin": {"pod_modes": 8},
    "reduced": {"anchors": 8},
}
"""Options of size ``tiny``; others have their defaults."""
OF_TASK: Mapping[tuple[str, str], Mapping[str, Any]] = {
    # the paper's best configuration and batch on dataset 1; on dataset 2 the default
    ("physgnn", "dataset-1-paths"): {"configuration": 9, "dataset": 1},
    ("physgnn", "dataset-1-nodes"): {"configuration": 9, "dataset": 1},
    ("physgnn", "tonutti-2017"): {"configuration": 9, "dataset": 1},
    # several bodies, none of which is the one tested
    ("lifted", "mesh-never-seen"): {"any_axes": True},
    # no point of a measured surface says which point of the body it was
    ("cnn", "registration-surface"): {"matched": True},
}
BATCH_SIZES: Mapping[tuple[str, str], int] = {
    ("physgnn", "dataset-1-paths"): 4,
    ("physgnn", "dataset-1-nodes"): 4,
    ("physgnn", "tonutti-2017"): 4,
}
TRAINING: Mapping[str, Any] = {
    "schedule": "cosine",
    "early_stopping": 1000,  # the last, slow steps of a cosine are its best
    "clock": "processor",
}
RATES: Mapping[str, float] = {
    "meshgraphnet": 1e-3, "transolver": 1e-3, "cnn": 1e-3,
}  # fmt: skip
"""Learning rates as their authors have them, to within a factor of ten; others have
the default of training, PhysGNN's published one."""
MEMORY_MB: Mapping[str, int] = {"meshgraphnet": 4096, "transolver": 4096}
"""Memory of training, where the default does not hold one sample of 10,000 points."""
TOLD_MORE: Mapping[str, str] = {
    "cnn": "is told how the surface within 30 mm of the load moved, which no other "
    "method is, and not the load",
}
"""What a method is told that the others are not, where loads are given."""
MINUTES: Mapping[str, float] = {"tiny": 0.1, "full": 30.0}
"""Processor minutes that a network trains if nothing else is said."""


@dataclass(frozen=True)
class Method:
    """One method as a task asks for it.

    Attributes
    ----------
    name : str
        As in the table.
    model : str
        A row of ``MODELS``, ``module:Class``, or the name itself where it is none.
    options : mapping
        All of the model's options.
    tolerance_mm : float or None
        What every prediction is repaired to.
    training : mapping
        Fields of a `physgnn.learning.training.config.TrainingConfig` beside model,
        options, budget and seed.
    """

    name: str
    model: str
    options: Mapping[str, Any]
    tolerance_mm: float | None = None
    training: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, task: str, size: str) -> "Method":
        """Return a method with the options that a task and a size give it."""
        if name in SHIFTS_ONLY:
            return cls(name, name, {})
        model = REPAIRS if name == REPAIRED else name
        small = SMALL.get(model, {}) if size == "tiny" else {}
        options = {**small, **OF_TASK.get((model, task), {})}
        training = dict(TRAINING)
        if model in RATES:
            training["learning_rate"] = RATES[model]
        if model in MEMORY_MB:
            training["memory_mb"] = MEMORY_MB[model]
        if (model, task) in BATCH_SIZES:
            training["batch_size"] = BATCH_SIZES[model, task]
        return cls(
            name,
            model,
            resolved_options(model, options),
            TOLERANCE_MM if name == REPAIRED else None,
            training,
        )


def method_names() -> tuple[str, ...]:
    """Return the names of all methods, those that take measured shifts last.

    A new row of ``MODELS`` is among them without more.
    """
    others = [name for name in MODELS if name not in (*CHEAP, *SOLVERS)]
    cheap = [name for name in CHEAP if name in MODELS]
    return (*cheap, *others, REPAIRED, *SHIFTS_ONLY)


def trains(name: str) -> bool:
    """Return whether a method is a network, or made of one, that trains by steps."""
    model = REPAIRS if name == REPAIRED else name
    return name not in SHIFTS_ONLY and issubclass(model_class(model), Network)


def _check_class(name: str) -> None:
    """Raise InputError unless a method can be imported and its options recorded."""
    try:
        model_class(name)
        json.dumps(resolved_options(name, {}), allow_nan=False)
    except InputError:
        raise
    except (TypeError, ValueError) as error:
        raise InputError(
            f"method '{name}' must have a default for every option, such as JSON can "
            f"hold ({error})"
        ) from error
    except Exception as error:  # a stranger's module may raise anything
        raise InputError(
            f"method '{name}' cannot be imported ({type(error).__name__}: {error})"
        ) from error


def named_methods(text: str) -> tuple[str, ...]:
    """Return the methods that a name, names with commas, or ``all`` stand for.

    The trivial ones are always among them.

    Raises
    ------
    InputError
        If there is no such method, or it cannot be imported.
    """
    if text == "all":
        return method_names()
    names = [name.strip() for name in text.split(",")]
    for name in names:
        known = name in (REPAIRED, *SHIFTS_ONLY)
        if name in SOLVERS or not (known or is_model(name)):
            raise InputError(
                f"no method '{name}' (there are: {', '.join(method_names())}; all; or "
                "one of your own as module:Class)"
            )
        if not known:
            _check_class(name)
    return tuple(dict.fromkeys([*TRIVIAL, *names]))
