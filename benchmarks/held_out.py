"""What benchmarks on held-out samples share: which ones, and a log to resume from."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.prediction import PredictionStatus

Sample = tuple[int, int]
USABLE = {status.name for status in PredictionStatus if status.usable}


def spread(samples: np.ndarray, per_level: int, seed: int = 0) -> list[Sample]:
    """Pick samples of every level, from other paths each time."""
    rng = np.random.default_rng(seed)
    levels = np.unique(samples[:, 1])
    picked = []
    for level in levels:
        paths = samples[samples[:, 1] == level, 0]
        some = rng.permutation(paths)[:per_level]
        picked += [(int(path), int(level)) for path in some]
    # In an order that is spread over levels, so that a part is a fair sample too.
    return [picked[i] for i in rng.permutation(len(picked))]


class Log:
    """One JSON object a line; what is there is not measured again.

    Levels are 0-based in samples, as in code, and count from 1 in the log.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        lines = file.read_text("utf-8").splitlines() if file.is_file() else []
        self.records = [json.loads(line) for line in lines]
        self._there = {self._key(record) for record in self.records}

    @staticmethod
    def _key(record: dict[str, Any]) -> tuple[Any, ...]:
        return record["path"], record["level"], record["what"]

    def missing(self, samples: list[Sample], what: str) -> Iterator[Sample]:
        """Yield the samples without this measurement."""
        for path, level in samples:
            if (path, level + 1, what) not in self._there:
                yield path, level

    def add(self, **record: Any) -> None:
        """Keep a record: path, level, what, and what was measured."""
        self.records.append(record)
        self._there.add(self._key(record))
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")

    def of(self, what: str) -> list[dict[str, Any]]:
        """Return the records of one measurement."""
        return [record for record in self.records if record["what"] == what]


def lengths(field: np.ndarray) -> tuple[float, float]:
    """Return mean and largest length over points."""
    length = np.linalg.norm(field, axis=1)
    return float(length.mean()), float(length.max())
