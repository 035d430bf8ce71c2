"""What a training finds in its folder, and where it begins from there.

Files are written in this order, each whole or not at all: the record; after a
validation better than all before, weights, record and mesh together
(`physgnn.learning.runs.parts`); at the end of every epoch and every few minutes the
state; at the very end the record again, the model card and the error bounds. A training
that was killed between any two of them goes on from the state, or from the beginning
if there is none yet.
"""

import logging
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import torch

from physgnn.errors import InputError
from physgnn.io.integrity.strays import clear_strays
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.parts import check_part, write_parts
from physgnn.learning.runs.record import check_same_run, record_text
from physgnn.learning.training.config import TrainingConfig

HOW = "resume it (physgnn train --resume), or name another folder"


def prepare(run: Path, record: Mapping[str, Any]) -> None:
    """Make a new run's folder, with its record.

    Raises
    ------
    InputError
        If the folder holds a run already.
    """
    files = RunFolder(run)
    if files.weights.exists() or files.state.exists():
        raise InputError(f"{run} holds a run already: {HOW}")
    run.mkdir(parents=True, exist_ok=True)
    clear_strays(run)
    text = record_text({**record, "manifest": files.manifest.name})
    write_parts(run, {files.record: lambda part: part.write_text(text, "utf-8")})


def find_state(run: Path, record: Mapping[str, Any]) -> Path | None:
    """Return the state that a training goes on from; None: from the beginning.

    Raises
    ------
    InputError
        If the folder holds no run, another, one whose files were changed, or a finished
        one without a state.
    """
    files = RunFolder(run)
    check_same_run(run, record, asdict(TrainingConfig()))
    clear_strays(run)
    for part in (files.case, files.weights):
        if part.is_file():
            check_part(part)
    if _is_readable(files.state):
        return files.state
    if files.model_card.exists():
        raise InputError(
            f"{run} holds no run to resume: its training is finished, and it has no "
            f"readable {files.state.name} to go on from; name another folder"
        )
    logging.getLogger(__name__).warning(
        "physgnn: %s has no readable %s: training begins anew", run, files.state.name
    )
    return None


def _is_readable(state: Path) -> bool:
    try:
        torch.load(state, map_location="cpu", weights_only=True)
    except (OSError, EOFError, RuntimeError, ValueError, KeyError, UnpicklingError):
        return False
    return True
