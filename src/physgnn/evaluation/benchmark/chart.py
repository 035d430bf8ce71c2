"""Error over the time of a prediction, and over what training took."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from physgnn.evaluation.benchmark.result import BenchmarkResult
from physgnn.evaluation.benchmark.table import by_task, ranked
from physgnn.evaluation.measure.distribution import Distribution
from physgnn.evaluation.report.style import LABELS_AND_COLOURS, LIGHT, colour, label
from physgnn.io.integrity.atomic import whole_file

LEGEND_COLUMNS = 5
MARKERS = "os^vDPXp"  # with the colour they tell all methods from each other
LEAST_MINUTES, LEAST_MS, LEAST_MM = 1e-4, 1e-3, 1e-4  # what is less is drawn there


def draw_benchmark(results: Sequence[BenchmarkResult], path: Path) -> None:
    """Draw a row of two charts for each task and size.

    Left: mean error over the time of a prediction. Right: mean error over processor
    minutes of training, of tasks where something learns; where a method has epochs,
    the line is its validation loss, of other samples than the test's.

    Parameters
    ----------
    results : sequence of BenchmarkResult
        Of any tasks and sizes.
    path : path
        SVG or PNG to write, whole or not at all.
    """
    groups = {key: ranked(rows) for key, rows in by_task(results).items()}
    groups = {key: found for key, found in groups.items() if found}
    rows = max(len(groups), 1)
    # without a fixed salt, and without a date, no two files would be the same; text
    # that stays text keeps the file small
    settings = {
        **LIGHT.settings(),
        "svg.hashsalt": "physgnn",
        "svg.fonttype": "none",
    }
    with mpl.rc_context(settings):
        figure = Figure(figsize=(9.6, 3.4 * rows + 1.4), layout="constrained")
        grid = figure.subplots(rows, 2, squeeze=False)
        known: dict[str, Line2D] = {}
        for axes, ((task, size), found) in zip(grid, groups.items(), strict=False):
            known |= _draw(axes[0], axes[1], found)
            axes[0].set(title=f"{task}, {size}", xlabel="a prediction, ms")
            axes[1].set(xlabel="training, processor minutes")
            axes[0].set_ylabel("mean error, mm")
        if known:
            _legend(figure, known)
        with whole_file(path) as part:
            metadata = {"Date": None} if path.suffix == ".svg" else None
            figure.savefig(part, facecolor="white", metadata=metadata)


def _legend(figure: Figure, known: dict[str, Line2D]) -> None:
    """Name the methods above all charts, in the order of the table of methods."""
    names = sorted(known, key=_place)
    figure.legend(
        [known[name] for name in names], [label(name) for name in names],
        loc="outside upper center", ncols=LEGEND_COLUMNS, fontsize=8,
    )  # fmt: skip


def _draw(
    time: Axes, budget: Axes, found: Sequence[tuple[BenchmarkResult, Distribution]]
) -> dict[str, Line2D]:
    known = {}
    for row, errors in found:
        name, error = row.identity.method, max(errors.mean, LEAST_MM)
        marker = MARKERS[_place(name) % len(MARKERS)]
        mark: dict[str, Any] = {
            "color": colour(name), "marker": marker, "linestyle": "none",
        }  # fmt: skip
        (known[name],) = time.loglog(
            [max(row.milliseconds or 0.0, LEAST_MS)], [error], **mark
        )
        spent = max(row.processor_minutes or 0.0, LEAST_MINUTES)
        budget.loglog([spent], [error], **mark)
        if row.curve:
            minutes, losses = zip(*row.curve, strict=True)
            budget.loglog(
                minutes, losses, "-", color=colour(name), linewidth=1.2, alpha=0.7
            )
    budget.set_visible(any(row.processor_minutes for row, _ in found))
    return known


def _place(name: str) -> int:
    """Return where a method stands among all that have a colour; others are last."""
    order = list(LABELS_AND_COLOURS)
    return order.index(name) if name in order else len(order)
