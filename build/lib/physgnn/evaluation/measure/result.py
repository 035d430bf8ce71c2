"""What an evaluation gives back, and its JSON form."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from physgnn.errors import InputError
from physgnn.evaluation.measure.distribution import Distribution
from physgnn.evaluation.measure.metrics import SampleError, SampleSummary
from physgnn.io.integrity.atomic import write_whole

FORMAT = "physgnn-evaluation"
VERSION = 2


@dataclass(frozen=True)
class ModelErrors:
    """Errors of one predictor over the samples of an evaluation.

    Attributes
    ----------
    name : str
    by_component : mapping of str to Distribution
        x, y, z, euclidean and position errors over all nodes and samples.
    by_region : mapping of str to Distribution
        Euclidean error in the loaded region, and in the tumour if there is one.
    by_level : tuple of Distribution or None
        Euclidean error at every level; None where no sample was evaluated.
    histogram : tuple of int
        Counts of Euclidean errors: those that count as zero, then one count a step of
        `distribution.HISTOGRAM_EDGES_MM`.
    summary : SampleSummary
    samples : tuple of SampleError
        In the order they were evaluated.
    seed : int or None
        Of its training; None where nothing is drawn.
    minutes : float or None
        What training it took.
    tolerance_mm : float or None
        What was asked of every prediction.
    """

    name: str
    by_component: Mapping[str, Distribution]
    by_region: Mapping[str, Distribution]
    by_level: tuple[Distribution | None, ...]
    histogram: tuple[int, ...]
    summary: SampleSummary
    samples: tuple[SampleError, ...]
    seed: int | None = None
    minutes: float | None = None
    tolerance_mm: float | None = None

    @property
    def euclidean(self) -> Distribution:
        """Distribution of the Euclidean error over all nodes and samples."""
        return self.by_component["euclidean"]

    @property
    def worst(self) -> SampleError:
        """The sample with the largest nodal error."""
        return max(self.samples, key=lambda sample: sample.largest)


@dataclass(frozen=True)
class Report:
    """Errors of several predictors on the same samples.

    Attributes
    ----------
    split : str
        Name of the split the samples come from.
    load_factors : tuple of float
        Load factor of every level.
    models : tuple of ModelErrors
        In the order of presentation, the model under test last. Those of one name
        differ in their seed.
    facts : mapping of str to JSON
        Where the numbers come from: versions, seeds, hashes, times of the solver.
    """

    split: str
    load_factors: tuple[float, ...]
    models: tuple[ModelErrors, ...]
    facts: Mapping[str, Any]

    @property
    def groups(self) -> tuple[tuple[ModelErrors, ...], ...]:
        """The models, those of one name together."""
        names = dict.fromkeys(model.name for model in self.models)
        return tuple(
            tuple(model for model in self.models if model.name == name)
            for name in names
        )

    def model(self, name: str) -> ModelErrors:
        """Return a predictor's errors, the first of its seeds.

        Raises
        ------
        InputError
            If there is none of this name; it tells those there are.
        """
        for errors in self.models:
            if errors.name == name:
                return errors
        have = ", ".join(errors.name for errors in self.models)
        raise InputError(f"the report has no model '{name}' (it has: {have})")

    def with_facts(self, **facts: Any) -> "Report":
        """Return the same report with these facts added."""
        return replace(self, facts={**self.facts, **facts})

    def write(self, path: Path) -> None:
        """Write the numbers as JSON, whole or not at all."""
        record = {"format": FORMAT, "version": VERSION, **asdict(self)}
        write_whole(path, json.dumps(record, indent=1, allow_nan=False))

    @classmethod
    def read(cls, path: Path) -> "Report":
        """Read what `write` wrote.

        Raises
        ------
        InputError
            If the file is something else or of another version.
        """
        try:
            record = dict(json.loads(path.read_text("utf-8")))
        except (OSError, ValueError, TypeError) as error:
            raise InputError(f"{path} is not a metrics file: {error}") from error
        found = (record.pop("format", None), record.pop("version", None))
        if found != (FORMAT, VERSION):
            raise InputError(
                f"{path} must be {FORMAT} version {VERSION} (got {found[0]} version "
                f"{found[1]}); evaluate again"
            )
        models = tuple(errors_from_json(model) for model in record.pop("models"))
        factors = tuple(record.pop("load_factors"))
        return cls(load_factors=factors, models=models, **record)


def errors_from_json(record: dict[str, Any]) -> ModelErrors:
    """Return what `dataclasses.asdict` and JSON made of a model's errors."""

    def distributions(values: dict[str, Any]) -> dict[str, Distribution]:
        return {name: Distribution(**value) for name, value in values.items()}

    return ModelErrors(
        **{key: record[key] for key in ("name", "seed", "minutes", "tolerance_mm")},
        by_component=distributions(record["by_component"]),
        by_region=distributions(record["by_region"]),
        by_level=tuple(v and Distribution(**v) for v in record["by_level"]),
        histogram=tuple(record["histogram"]),
        summary=SampleSummary(**record["summary"]),
        samples=tuple(SampleError(**sample) for sample in record["samples"]),
    )
