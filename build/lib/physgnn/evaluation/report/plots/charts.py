"""Charts of an evaluation: error over load level, distribution of errors, bounds."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from physgnn.evaluation.measure.distribution import HISTOGRAM_EDGES_MM
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report.style import DISPLACEMENT_MAP, colour
from physgnn.evaluation.report.tables import group_label

SMALLEST_SHOWN_MM = 1e-4
SHORT_AXIS = 50.0  # highest over lowest value
SPARSE_LEVELS = 8  # few enough for larger dots
LEGEND_COLUMNS = 4


def level_chart(report: Report) -> Figure:
    """Mean and largest Euclidean error over the load factor, every predictor.

    Of several seeds the mean, and a band from the lowest to the highest.
    """
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    for i, (title, attribute) in enumerate(
        (
            ("Mean error of a node", "mean"),
            ("Largest error, mean over samples", "largest"),
        )
    ):
        axes = figure.add_subplot(1, 2, i + 1)
        axes.set(title=title, xlabel="load, % of the full force", yscale="log")
        lines = [
            _draw_levels(axes, seeds, attribute, report.load_factors)
            for seeds in report.groups
        ]
        axes.set_xlim(0, None)
        _label_millimetres(axes.yaxis)
    names = [group_label(seeds) for seeds in report.groups]
    columns = min(len(names), LEGEND_COLUMNS)
    figure.legend(lines, names, loc="outside lower center", ncols=columns)
    return figure


def _draw_levels(
    axes: Axes, seeds: Sequence[ModelErrors], attribute: str, factors: Sequence[float]
) -> Line2D:
    """Draw one predictor's line and, of several seeds, the band about it."""
    levels, _ = _by_level(seeds[0], attribute, len(factors))
    values = np.array([_by_level(m, attribute, len(factors))[1] for m in seeds])
    values = np.maximum(values, SMALLEST_SHOWN_MM)
    load, paint = 100 * np.array(factors)[levels], colour(seeds[0].name)
    mean = values.mean(axis=0)
    size = 3 if len(levels) > SPARSE_LEVELS else 4.5
    (line,) = axes.plot(
        load, mean, color=paint, linewidth=2, marker="o", markersize=size
    )
    if len(seeds) > 1:
        band = values.min(axis=0), values.max(axis=0)
        axes.fill_between(load, *band, color=paint, alpha=0.25, linewidth=0)
    return line


def _by_level(
    model: ModelErrors, attribute: str, n_levels: int
) -> tuple[list[int], list[float]]:
    """Return levels with samples and the mean over samples of an error there."""
    values: list[list[float]] = [[] for _ in range(n_levels)]
    for sample in model.samples:
        values[sample.level].append(getattr(sample, attribute))
    levels = [level for level in range(n_levels) if values[level]]
    return levels, [float(np.mean(values[level])) for level in levels]


def histogram_chart(report: Report) -> Figure:
    """Distribution of the Euclidean error over all nodes and samples."""
    figure = Figure(figsize=(9.6, 4.0), layout="constrained")
    axes = figure.subplots()
    edges = np.array(HISTOGRAM_EDGES_MM)
    shown = edges[:-1] >= SMALLEST_SHOWN_MM
    largest = max(model.euclidean.largest for model in report.models)
    for seeds in report.groups:
        counts = np.sum([model.histogram for model in seeds], axis=0)
        percent = 100 * counts[1:] / max(counts.sum(), 1)
        paint = colour(seeds[0].name)
        axes.stairs(
            percent[shown],
            edges[np.append(shown, True)],
            color=paint,
            linewidth=1.8,
            label=group_label(seeds),
        )
        if seeds == report.groups[-1]:  # the model under test; more would hide lines
            axes.stairs(
                percent[shown],
                edges[np.append(shown, True)],
                color=paint,
                fill=True,
                alpha=0.14,
            )
    axes.axvline(1.0, color=axes.xaxis.label.get_color(), linewidth=1, linestyle="--")
    axes.set(
        title="Error of a node, all nodes of all samples",
        xscale="log",
        xlim=(SMALLEST_SHOWN_MM, 1.5 * largest),
        ylim=(0, None),
        xlabel="Euclidean error (dashed: 1 mm)",
        ylabel="nodes, %",
    )
    _label_millimetres(axes.xaxis)
    columns = min(len(report.groups), LEGEND_COLUMNS)
    figure.legend(loc="outside lower center", ncols=columns)
    return figure


def estimate_chart(model: ModelErrors) -> Figure:
    """Error bound over true error, a dot a sample; on or above the line it held."""
    figure = Figure(figsize=(9.6, 4.2), layout="constrained")
    for axes, title, true, bound in (
        (figure.add_subplot(1, 2, 1), "Mean error", "mean", "estimate_mean"),
        (figure.add_subplot(1, 2, 2), "Largest error", "largest", "estimate_largest"),
    ):
        pairs = [(getattr(s, true), getattr(s, bound)) for s in model.samples]
        x, y = np.array([pair for pair in pairs if pair[1] is not None]).T
        shade = [s.load_factor for s in model.samples if s.estimate_mean is not None]
        dots = axes.scatter(x, y, c=shade, cmap=DISPLACEMENT_MAP, s=14, vmin=0, vmax=1)
        ends = [0.8 * min(x.min(), y.min()), 1.25 * max(x.max(), y.max())]
        axes.plot(ends, ends, color=axes.xaxis.label.get_color(), linewidth=1)
        held = 100 * np.mean(x <= y)
        axes.set(
            title=f"{title}: the bound held in {held:.0f} % of samples",
            xscale="log",
            yscale="log",
            xlabel="true error",
            ylabel="bound",
        )
        for axis in (axes.xaxis, axes.yaxis):
            _label_millimetres(axis)
    figure.colorbar(dots, ax=figure.axes, label="load factor", shrink=0.85)
    return figure


def _label_millimetres(axis: Axis) -> None:
    """Label a logarithmic axis in mm: decades, and 2 and 5 between if it is short."""
    low, high = axis.get_view_interval()
    between = (1.0, 2.0, 5.0) if high < SHORT_AXIS * low else (1.0,)
    axis.set_major_locator(LogLocator(subs=between))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g} mm"))
    axis.set_minor_formatter(NullFormatter())
