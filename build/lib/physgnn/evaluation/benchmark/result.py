"""One result: a method on a task, as one JSON file that is whole or not there."""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import TypeAdapter

from physgnn.errors import InputError
from physgnn.evaluation.benchmark.tasks import OVER_TUMOUR, SIZES, TASKS
from physgnn.evaluation.measure.distribution import Distribution
from physgnn.evaluation.measure.result import ModelErrors
from physgnn.io.integrity.atomic import write_whole
from physgnn.io.untrusted.input_errors import reading

FORMAT, VERSION = "physgnn-benchmark", 1
LARGEST_BYTES = 16 * 2**20  # a result takes a few kilobytes
MEASURED: Final = "measured"
NOT_APPLICABLE: Final = "not applicable"
FAILED: Final = "failed"


@dataclass(frozen=True)
class Errors:
    """Euclidean errors of a method over its test samples, mm.

    Attributes
    ----------
    all_points, loaded_region, tumour : Distribution
        Mean, standard deviation, median, 95 and 99 %, largest, and the fraction within
        1 mm, over nodes and samples; None where no node is.
    largest_per_sample : float
        The mean over samples of the largest error.
    relative : float
        The mean over samples of ‖u − û‖ / ‖u‖.
    n_samples : int
        How many samples were tested.
    """

    all_points: Distribution
    loaded_region: Distribution | None
    tumour: Distribution | None
    largest_per_sample: float
    relative: float
    n_samples: int

    @classmethod
    def of(cls, measured: ModelErrors) -> "Errors":
        """Return the part of an evaluation's errors that a result keeps."""
        return cls(
            measured.euclidean,
            measured.by_region.get("loaded_region"),
            measured.by_region.get("tumour"),
            measured.summary.largest_error_mean,
            measured.summary.relative_mean,
            measured.summary.n_samples,
        )

    def over(self, where: str) -> Distribution:
        """Return the errors that rank the methods of a task."""
        inside = self.tumour if where == OVER_TUMOUR else None
        return inside or self.all_points


@dataclass(frozen=True)
class Identity:
    """All that a result follows from: results of the same are not made anew.

    Attributes
    ----------
    task, version, size : str, int, str
        A row of ``TASKS``, and whether it is the tiny one.
    method, options : str, mapping
        Which method, with all of its options and settings of training.
    origin : str
        A digest of the file that a method from outside the package is in.
    data, split : mapping
        Hashes of both, and what they are.
    seed : int or None
        None where nothing is drawn.
    processor_minutes : float or None
        What a network may train; None for what is fitted in one go.
    """

    task: str
    version: int
    size: str
    method: str
    options: Mapping[str, Any]
    origin: str
    data: Mapping[str, Any]
    split: Mapping[str, Any]
    seed: int | None
    processor_minutes: float | None

    @property
    def key(self) -> str:
        """Sixteen hexadecimal digits, others for any other result."""
        text = json.dumps(asdict(self), sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def file(self, folder: Path) -> Path:
        """Return where in a folder of results this one lies."""
        method = "".join(c if c.isalnum() or c in "-_." else "." for c in self.method)
        return folder / f"{self.task}-{self.size}" / f"{method}-{self.key}.json"


@dataclass(frozen=True)
class BenchmarkResult:
    """What a method reached on a task.

    Attributes
    ----------
    identity : Identity
        What it follows from.
    status : str
        ``measured``, ``not applicable`` or ``failed``; the last is tried again.
    reason : str
        Why there are no errors.
    errors : Errors or None
        On the test samples.
    processor_minutes : float or None
        What training or fitting took, all threads together.
    milliseconds : float or None
        The median time of a prediction, by the wall clock.
    memory_mb : float or None
        How far the process grew beyond where it was, at most, while the method was
        made and measured.
    curve : tuple of (minutes, mm)
        Processor minutes and validation loss of every epoch, of what has epochs.
    versions, machine : mapping
        What it was measured with, and on.
    """

    identity: Identity
    status: Literal["measured", "not applicable", "failed"]
    reason: str = ""
    errors: Errors | None = None
    processor_minutes: float | None = None
    milliseconds: float | None = None
    memory_mb: float | None = None
    curve: tuple[tuple[float, float], ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    machine: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if (self.errors is not None) != (self.status == MEASURED):
            raise InputError(
                f"a result that is {self.status} must say so by its errors"
            )

    def write(self, folder: Path) -> Path:
        """Write it as JSON into a folder of results, whole or not at all."""
        file = self.identity.file(folder)
        file.parent.mkdir(parents=True, exist_ok=True)
        record = {"format": FORMAT, "version": VERSION, **asdict(self)}
        write_whole(file, json.dumps(record, indent=1, allow_nan=False) + "\n")
        return file

    @classmethod
    def read(cls, file: Path) -> "BenchmarkResult":
        """Read what `write` wrote.

        Raises
        ------
        InputError
            If the file is something else, damaged or of another version.
        """
        with reading(file, f"a result of physgnn benchmark, version {VERSION}"):
            if file.stat().st_size > LARGEST_BYTES:
                raise InputError(
                    f"a result has at most {LARGEST_BYTES} bytes "
                    f"(got {file.stat().st_size})"
                )
            record = json.loads(file.read_text("utf-8"), parse_constant=_refused)
            found = record.pop("format", None), record.pop("version", None)
            if found != (FORMAT, VERSION):
                raise InputError(
                    f"expected {FORMAT} version {VERSION} (got {found[0]} version "
                    f"{found[1]}): delete it, and measure again"
                )
            unknown = sorted({*record} - {each.name for each in fields(cls)})
            if unknown:
                raise InputError(f"a result has no field '{unknown[0]}'")
            return _ADAPTER.validate_python(record)


def _refused(constant: str) -> float:
    raise InputError(f"a result has finite numbers only (got {constant})")


def read_results(folder: Path) -> list[BenchmarkResult]:
    """Return all results of a folder, by task and name of file.

    Raises
    ------
    InputError
        If there are none, or one is damaged.
    """
    folders = [folder / f"{task}-{size}" for task in TASKS for size in SIZES]
    files = [file for each in folders for file in sorted(each.glob("*.json"))]
    results = [BenchmarkResult.read(file) for file in files]
    if not results:
        raise InputError(
            f"{folder} holds no results of physgnn benchmark: make some with "
            "physgnn benchmark --task NAME -o FOLDER"
        )
    return results


def is_finite(errors: ModelErrors) -> bool:
    """Return whether an evaluation's errors are numbers."""
    return math.isfinite(errors.euclidean.mean + errors.euclidean.largest)


_ADAPTER: TypeAdapter[BenchmarkResult] = TypeAdapter(BenchmarkResult)
