"""Measured rows on disk, so that one more costs no more than itself."""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path

from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.result import ModelErrors, errors_from_json
from physgnn.evaluation.measure.rows import Row
from physgnn.io.integrity.atomic import write_whole


class CachedRows:
    """Errors of rows measured earlier, in a folder, one file each.

    A file's name holds a hash of all that its figures follow from: data, samples,
    seed, weights, tolerance. Those of other data are never found again.

    Parameters
    ----------
    folder : path
        Made when the first row is put there.
    held_out : HeldOut
        Data and samples.
    """

    def __init__(self, folder: Path, held_out: HeldOut) -> None:
        self._folder = folder
        self._digest = hashlib.sha256(held_out.store.content_hash().encode())
        for samples in (held_out.train, held_out.test):
            self._digest.update(samples.astype("<i8").tobytes() + b"|")

    def get(self, row: Row) -> ModelErrors | None:
        """Return what was put there, or None."""
        file = self._file(row)
        return errors_from_json(json.loads(file.read_text())) if file.exists() else None

    def put(self, row: Row, errors: ModelErrors) -> None:
        """Store a row, whole or not at all."""
        self._folder.mkdir(parents=True, exist_ok=True)
        write_whole(self._file(row), json.dumps(asdict(errors), allow_nan=False))

    def _file(self, row: Row) -> Path:
        digest = self._digest.copy()
        digest.update(repr((row.seed, row.origin, row.tolerance_mm)).encode())
        name = row.name.replace(":", ".")  # of module:Class
        return self._folder / f"{name}-{digest.hexdigest()[:16]}.json"
