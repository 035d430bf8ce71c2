"""A run folder as the package carries it: what predictions need, and nothing else."""

import shutil
from pathlib import Path

from physgnn.errors import InputError
from physgnn.learning.runs.folder import RunFolder

MAX_BYTES = 5_000_000
MADE_BY = "make bundled"


def check_size(run: Path) -> None:
    """Raise InputError if a run is larger than the package may carry."""
    size = sum(file.stat().st_size for file in run.iterdir())
    if size > MAX_BYTES:
        raise InputError(
            f"{run} must have at most {MAX_BYTES} bytes (got {size}): use fewer points "
            "or modes"
        )


def slim_copy(run: Path, out: Path, *, errors: str) -> None:
    """Copy what predictions need of a run, without paths of the machine it's from.

    Parameters
    ----------
    run, out : Path
        Run folders.
    errors : str
        For the model card, Markdown.
    """
    from physgnn.learning.runs.checkpoint import Checkpoint
    from physgnn.learning.runs.model_card import write_model_card
    from physgnn.prediction.error_bounds.calibration import Calibration

    files, copies = RunFolder(run), RunFolder(out)
    checkpoint = Checkpoint.load(run)
    data = {**checkpoint.record["data"], "path": MADE_BY, "paths": [MADE_BY]}
    data.pop("stores", None)
    out.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(files.case, copies.case)
    Checkpoint(checkpoint.model, {**checkpoint.record, "data": data}).save(out)
    for calibration in files.calibrations:
        Calibration.read(calibration).write(out / calibration.name)
    write_model_card(out, errors)
