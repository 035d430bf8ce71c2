"""Tables of an evaluation: one row a predictor, as text and for the report."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.evaluation.distribution import Distribution
from physgnn.evaluation.metrics import COMPONENTS, LOADED_REGION_MM
from physgnn.evaluation.published import PUBLISHED
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.evaluation.style import label

NONE = "—"
PUBLISHED_ROW = "Published test set"
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


def accuracy_table(report: Report) -> Table:
    """Return the table that compares predictors at a glance."""
    columns: Mapping[str, Callable[[ModelErrors], str]] = {
        "mean": lambda m: mm(m.euclidean.mean),
        "median": lambda m: mm(m.euclidean.median),
        "95 %": lambda m: mm(m.euclidean.percentile_95),
        "99 %": lambda m: mm(m.euclidean.percentile_99),
        "largest": lambda m: mm(m.euclidean.largest),
        "largest, per sample": lambda m: mm(m.summary.largest_error_mean),
        "≤ 1 mm": lambda m: percent(m.euclidean.within_1mm),
        "relative": lambda m: percent(m.summary.relative_mean),
        "relative, pooled": lambda m: percent(m.summary.relative_pooled),
        "loaded region": lambda m: _region(m, "loaded_region"),
        "tumour": lambda m: _region(m, "tumour"),
        "time": lambda m: duration(m.summary.median_seconds),
    }
    return Table(
        "Error of every predictor, mm",
        ("", *columns),
        tuple(
            (label(m.name), *(cell(m) for cell in columns.values()))
            for m in report.models
        ),
        "Euclidean distance between predicted and true displacement over all nodes "
        "and samples. Largest per sample: mean over samples. Relative: mean over "
        "samples of ‖u - û‖ / ‖u‖; pooled: mean error over mean "
        f"displacement. Loaded region: points within {LOADED_REGION_MM:g} mm of a "
        "loaded point. Time: median of a prediction.",
    )


def protocol_table(report: Report, preset: str = "") -> Table:
    """Return the means and shares of the publication, its own in the last row."""
    rows = [
        _protocol_row(model.by_component, label(model.name)) for model in report.models
    ]
    if preset in PUBLISHED:
        published = PUBLISHED[preset]
        errors = [spread(*getattr(published, name)) for name in COMPONENTS]
        errors.insert(4, percent(published.within_1mm))
        rows.append((PUBLISHED_ROW, *errors, percent(published.position_within_1mm)))
    return Table(
        "Errors as published, mm",
        (
            "",
            "MAE x",
            "MAE y",
            "MAE z",
            "mean Euclidean",
            "≤ 1 mm",
            "mean abs. position",
            "≤ 1 mm",
        ),
        tuple(rows),
        "± is the standard deviation over nodes and samples. Absolute position error: "
        "difference of the displacements' magnitudes. The published figures were "
        "measured on another mesh of the same brain and on the split that shares load "
        "paths between training and test set.",
    )


def _protocol_row(errors: Mapping[str, Distribution], name: str) -> tuple[str, ...]:
    cells = [spread(errors[c].mean, errors[c].std) for c in COMPONENTS]
    cells.insert(4, percent(errors["euclidean"].within_1mm))
    return (name, *cells, percent(errors["position"].within_1mm))


def extremes_table(report: Report, preset: str = "") -> Table:
    """Return the medians and the largest errors of the publication."""
    rows = [
        (
            label(model.name),
            *(mm(model.by_component[name].median) for name in COMPONENTS),
            mm(model.summary.largest_displacement),
            spread(
                model.summary.largest_displacement_mean,
                model.summary.largest_displacement_std,
            ),
            spread(model.summary.largest_error_mean, model.summary.largest_error_std),
        )
        for model in report.models
    ]
    if preset in PUBLISHED:
        published = PUBLISHED[preset]
        rows.append(
            (
                PUBLISHED_ROW,
                *(mm(median) for median in published.medians),
                mm(published.largest_displacement),
                spread(*published.largest_displacement_per_sample),
                spread(*published.largest_error_per_sample),
            )
        )
    return Table(
        "Medians and extremes as published, mm",
        (
            "",
            "median x",
            "median y",
            "median z",
            "median Euclidean",
            "median position",
            "largest displacement",
            "largest displacement, per sample",
            "largest error, per sample",
        ),
        tuple(rows),
        "Largest displacement is that of the true solution. Per sample: mean ± "
        "standard deviation over samples of the largest of a sample's nodes.",
    )


def level_table(report: Report) -> Table:
    """Return the mean Euclidean error at a few load levels."""
    present = [i for i, d in enumerate(report.models[0].by_level) if d is not None]
    picks = np.linspace(0, len(present) - 1, min(LEVELS_SHOWN, len(present)))
    levels = [present[round(pick)] for pick in picks]
    rows = []
    for model in report.models:
        means = [model.by_level[level] for level in levels]
        rows.append((label(model.name), *(mm(d.mean) if d else NONE for d in means)))
    return Table(
        "Mean Euclidean error over the load, mm",
        ("", *(f"{100 * report.load_factors[level]:.0f} % load" for level in levels)),
        tuple(rows),
    )


def mm(value: float) -> str:
    """Return millimetres to three significant digits, at most four decimals."""
    if value == 0 or value >= 100:
        return f"{value:.0f}"
    if value < 5e-5:
        return "< 0.0001"
    decimals = int(np.clip(2 - np.floor(np.log10(abs(value))), 0, 4))
    return f"{value:.{decimals}f}"


def spread(mean: float, std: float) -> str:
    """Return mean ± standard deviation."""
    return f"{mm(mean)} ± {mm(std)}"


def percent(share: float) -> str:
    """Return a share as per cent, its distance from 100 % kept in sight."""
    decimals = 2 if 0.99 < share < 1 else 1
    return f"{100 * share:.{decimals}f} %"


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it."""
    if seconds < 1:
        return f"{1e3 * seconds:.3g} ms"
    return f"{seconds:.3g} s"


def _region(model: ModelErrors, name: str) -> str:
    return mm(model.by_region[name].mean) if name in model.by_region else NONE
