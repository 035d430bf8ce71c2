"""Tables of an evaluation: one row a predictor, as text and for the report."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.evaluation.measure.gentle_loads import GENTLE_N, GentleLoads, mean_over
from physgnn.evaluation.measure.metrics import LOADED_REGION_MM
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report.formats import (
    NONE,
    duration,
    minutes,
    mm,
    percent,
    with_spread,
)
from physgnn.evaluation.report.style import label

LEVELS_SHOWN = 6


@dataclass(frozen=True)
class Table:
    """Cells as people read them.

    Attributes
    ----------
    title : str
    columns : tuple of str
        Headers; the first is that of the row names.
    rows : tuple of tuples of str
        As long as `columns`; the first cell names the row.
    note : str
        What the columns mean.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""

    def text(self) -> str:
        """Return the table as Markdown, columns aligned."""
        grid = (self.columns, *self.rows)
        widths = [max(len(row[i]) for row in grid) for i in range(len(self.columns))]
        lines = [
            "| "
            + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True))
            + " |"
            for row in grid
        ]
        lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
        return "\n".join((f"**{self.title}**", "", *lines))


@dataclass(frozen=True)
class Column:
    """One number of a predictor, how to write it, and whether seeds may differ."""

    value: Callable[[ModelErrors], float | None]
    text: Callable[[float], str] = mm
    spreads: bool = True

    def cell(self, seeds: Sequence[ModelErrors]) -> str:
        """Return the mean over seeds, with their standard deviation if several."""
        values = [v for v in map(self.value, seeds) if v is not None]
        if not values:
            return NONE
        mean = self.text(float(np.mean(values)))
        if len(values) == 1 or not self.spreads:
            return mean
        return with_spread(mean, float(np.std(values, ddof=1)))


def group_label(seeds: Sequence[ModelErrors]) -> str:
    """Return what a row is called: the predictor's name."""
    first = seeds[0]
    if first.tolerance_mm is None:
        return label(first.name)
    return f"{label(first.name)} to {first.tolerance_mm:g} mm"


def _region(name: str) -> Callable[[ModelErrors], float | None]:
    return lambda m: m.by_region[name].mean if name in m.by_region else None


ACCURACY: Mapping[str, Column] = {
    "mean": Column(lambda m: m.euclidean.mean),
    "median": Column(lambda m: m.euclidean.median),
    "95 %": Column(lambda m: m.euclidean.percentile_95),
    "99 %": Column(lambda m: m.euclidean.percentile_99),
    "largest": Column(lambda m: m.euclidean.largest),
    "largest, per sample": Column(lambda m: m.summary.largest_error_mean),
    "≤ 1 mm": Column(lambda m: m.euclidean.within_1mm, percent),
    "relative": Column(lambda m: m.summary.relative_mean, percent),
    "loaded region": Column(_region("loaded_region")),
    "tumour": Column(_region("tumour")),
    "time": Column(lambda m: m.summary.median_seconds, duration, spreads=False),
    "training": Column(lambda m: m.minutes, minutes, spreads=False),
}


def accuracy_table(report: Report) -> Table:
    """Return the table that compares predictors at a glance."""
    n_seeds = max(len(seeds) for seeds in report.groups)
    of_seeds = (
        f" ±: standard deviation over training seeds (up to {n_seeds})."
        if n_seeds > 1
        else ""
    )
    return Table(
        "Error of every predictor, mm",
        ("", *ACCURACY),
        tuple(
            (group_label(seeds), *(column.cell(seeds) for column in ACCURACY.values()))
            for seeds in report.groups
        ),
        "Euclidean distance between predicted and true displacement over all nodes "
        "and samples. Largest per sample: mean over samples. Relative: mean over "
        "samples of ‖u - û‖ / ‖u‖. Loaded region: points within "
        f"{LOADED_REGION_MM:g} mm of a loaded point. Time: median of a prediction. "
        f"Training: processor time, all threads together.{of_seeds}",
    )


def level_table(report: Report) -> Table:
    """Return the mean Euclidean error at a few load levels."""
    present = [i for i, d in enumerate(report.models[0].by_level) if d is not None]
    picks = np.linspace(0, len(present) - 1, min(LEVELS_SHOWN, len(present)))
    levels = [present[round(pick)] for pick in picks]
    columns = [Column(_level(level)) for level in levels]
    return Table(
        "Mean Euclidean error over the load, mm",
        ("", *(f"{100 * report.load_factors[level]:.0f} % load" for level in levels)),
        tuple(
            (group_label(seeds), *(column.cell(seeds) for column in columns))
            for seeds in report.groups
        ),
    )


def _level(level: int) -> Callable[[ModelErrors], float | None]:
    def mean(model: ModelErrors) -> float | None:
        distribution = model.by_level[level]
        return distribution.mean if distribution else None

    return mean


GENTLE: Mapping[str, tuple[str, Callable[[float], str]]] = {
    "mean": ("mean", mm),
    "largest, per sample": ("largest", mm),
    "relative": ("relative", percent),
    "loaded region": ("loaded_region", mm),
    "tumour": ("tumour", mm),
    "displacement": ("mean_displacement", mm),
}
"""Column → field of a sample's errors, and how to write it."""


def gentle_table(report: Report) -> Table | None:
    """Return the errors at loads of at most 0.3 N in all; None if there are none.

    See `physgnn.evaluation.measure.gentle_loads`.
    """
    loads = gentle_loads(report)
    if loads is None or not loads.samples:
        return None
    columns = {
        title: Column(mean_over(loads, name), text)
        for title, (name, text) in GENTLE.items()
    }
    return Table(
        f"At forces of at most {GENTLE_N:g} N, mm",
        ("", *columns),
        tuple(
            (group_label(seeds), *(column.cell(seeds) for column in columns.values()))
            for seeds in report.groups
        ),
        f"{len(loads.samples)} of {loads.n_samples} samples, by the sum of the nodal "
        "forces. Seven in ten of the forces measured in neurosurgery are that gentle "
        "(Gan et al. 2015). Means over samples; displacement: the true one, over all "
        "points.",
    )


def gentle_loads(report: Report) -> GentleLoads | None:
    """Return which samples have gentle loads, if the evaluation noted it."""
    record = report.facts.get("gentle_loads")
    return None if record is None else GentleLoads.from_json(record)


def tolerance_table(report: Report) -> Table | None:
    """Return how predictions with a tolerance fared, or None if there are none."""
    rows = [_tolerance_row(m) for m in report.models if m.tolerance_mm is not None]
    if not rows:
        return None
    return Table(
        "Predictions made to keep a tolerance",
        (
            "",
            "largest error",
            "within",
            "median time",
            "95 % of times",
            "longest",
            "ended",
        ),
        tuple(rows),
        "Within: samples whose largest nodal error is at most the tolerance, per cent.",
    )


def _tolerance_row(model: ModelErrors) -> tuple[str, ...]:
    seconds = [sample.seconds for sample in model.samples]
    endings = [s.status.lower().replace("_", " ") for s in model.samples]
    within = [s.largest <= (model.tolerance_mm or 0.0) for s in model.samples]
    return (
        group_label([model]),
        mm(model.euclidean.largest),
        percent(float(np.mean(within))),
        *(duration(float(np.quantile(seconds, q))) for q in (0.5, 0.95, 1.0)),
        ", ".join(f"{endings.count(end)} {end}" for end in dict.fromkeys(endings)),
    )
