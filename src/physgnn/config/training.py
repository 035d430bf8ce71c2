"""How to train (``physgnn train --config``).

The keys are the fields of `physgnn.learning.training.config.TrainingConfig`; a table
``[options]`` is for the model's own.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from physgnn.config.tables import read_as, read_toml, table_of
from physgnn.errors import InputError

if TYPE_CHECKING:
    from physgnn.learning.training.config import TrainingConfig

DEFAULT_MODEL = "lifted"
OF_PHYSGNN = frozenset(
    {"configuration", "dataset", "normaliser", "depth", "jumping_knowledge"}
)
"""Options that the published network alone has: who names one means it."""


def read_training(
    path: str | Path | None, *, default_model: str = DEFAULT_MODEL, **changes: Any
) -> "TrainingConfig":
    """Read a training configuration; `changes` that are not None win over the file.

    Where neither names a model it is `default_model`, or the published one if an option
    is its own.

    Parameters
    ----------
    path : path or None
        The TOML file; None for defaults and `changes` alone.
    default_model : str
        What is trained where neither names a model.
    **changes
        Fields of the configuration.

    Returns
    -------
    TrainingConfig
        The configuration.

    Raises
    ------
    InputError
        If the file cannot be read, or a key or value is wrong.
    """
    # torch takes seconds to import, and simulating does not need it
    from physgnn.learning.training.config import TrainingConfig

    values = {} if path is None else read_toml(path)
    table = values.pop("options", {})
    if not isinstance(table, dict):
        raise InputError(f"{path}: options must be a table, [options] (got {table!r})")
    options = {**table, **changes.pop("options", {})}
    given = {name: value for name, value in changes.items() if value is not None}
    model = default_model if OF_PHYSGNN.isdisjoint(options) else "physgnn"
    config: TrainingConfig = read_as(
        table_of(TrainingConfig),
        {"model": model, **values, **given, "options": options},
        "the training configuration" if path is None else path,
    )
    return config
