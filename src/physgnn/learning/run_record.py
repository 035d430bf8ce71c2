"""What a run folder says about itself, in plain JSON."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.learning.checkpoint import RECORD
from physgnn.learning.models import resolved_options
from physgnn.learning.training_config import TrainingConfig

VERSIONED = ("physgnn", "torch", "lightning", "numpy")
EXTENDABLE = {"max_epochs", "max_minutes", "memory_mb"}


def new_record(store: Store, split: Split, config: TrainingConfig) -> dict[str, Any]:
    """Return what is known before training."""
    options = resolved_options(config.model, config.options)
    return {
        "config": asdict(replace(config, options=options)),
        "versions": {name: version(name) for name in VERSIONED},
        "data": {"path": str(store.path), "hash": store.content_hash()},
        "split": {
            "name": split.name,
            "train": len(split.train),
            "validation": len(split.validation),
            "test": len(split.test),
            "hash": _digest(split),
        },
    }


def with_result(
    record: Mapping[str, Any], *, loss: float, minutes: float
) -> dict[str, Any]:
    """Return the record with what training reached and what it cost."""
    training = {"best_validation_loss": loss, "minutes": round(minutes, 3)}
    return {**record, "training": training}


def check_same_run(run: Path, record: Mapping[str, Any]) -> None:
    """Raise InputError unless a run can be resumed with this record's data and config.

    Only budget and memory may differ.
    """
    try:
        earlier = json.loads((run / RECORD).read_text())
    except (OSError, ValueError) as error:
        raise InputError(f"{run} holds no run to resume; start a new one") from error
    for part, what in (("data", "hash"), ("split", "hash")):
        if earlier[part][what] != record[part][what]:
            raise InputError(
                f"{run} was trained on another {part}; resume it with the same, or "
                "start a new run"
            )
    new, old = record["config"], earlier["config"]
    for name in sorted(new.keys() - EXTENDABLE):
        if new[name] != old.get(name):
            raise InputError(
                f"{run} was started with {name} = {old.get(name)} (got {new[name]}); "
                "resume it with the same, or start a new run"
            )


def _digest(split: Split) -> str:
    parts = (split.train, split.validation, split.test)
    rows = np.concatenate([np.append(part, [[-1, -1]], axis=0) for part in parts])
    return hashlib.sha256(rows.astype("<i8").tobytes()).hexdigest()
