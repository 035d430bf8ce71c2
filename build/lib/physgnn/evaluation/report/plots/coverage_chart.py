"""Charts of error bars: how near the estimate, how often bounds hold, how sharp."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from physgnn.evaluation.measure.coverage import (
    FACTOR,
    BarSample,
    bound_kinds,
    bound_pairs,
)
from physgnn.evaluation.report.style import SPARE_COLOURS

BINS = 6  # of the load factor
COLOURS = {"mean": "#2f7fd6", "largest": "#d9861a"}
RATIOS = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)


def bars_chart(samples: Sequence[BarSample]) -> Figure:
    """Estimate over true error, coverage and sharpness of the bounds, over the load."""
    figure = Figure(figsize=(9.6, 7.4), layout="constrained")
    axes = figure.subplots(2, 2)
    _draw_nearness(axes[0, 0], samples, "mean")
    _draw_nearness(axes[0, 1], samples, "largest")
    _draw_coverage(axes[1, 0], samples)
    _draw_sharpness(axes[1, 1], samples)
    for panel in axes.flat:
        panel.set(xlabel="load, % of the full force", xlim=(0, 103))
    return figure


def _draw_nearness(axes: Axes, samples: Sequence[BarSample], which: str) -> None:
    load = [100 * s.load_factor for s in samples]
    q = [getattr(s, f"likely_{which}") / getattr(s, which) for s in samples]
    axes.axhspan(1 / FACTOR, FACTOR, color=COLOURS[which], alpha=0.1, linewidth=0)
    axes.axhline(1.0, color=axes.xaxis.label.get_color(), linewidth=1)
    axes.scatter(load, q, s=12, color=COLOURS[which], alpha=0.7, linewidths=0)
    axes.set_title(f"Physical estimate over true {which} error")
    _ratio_axis(axes, q)


def _draw_coverage(axes: Axes, samples: Sequence[BarSample]) -> None:
    for promised in sorted({promised for _, promised in bound_kinds(samples)}):
        axes.axhline(100 * promised, color="grey", linewidth=1, linestyle="--")
    lowest = 90.0
    for i, (indicator, promised) in enumerate(bound_kinds(samples)):
        centres, values = [], []
        for centre, some in _binned(samples):
            true, bound = bound_pairs(some, indicator, promised)[..., 1].T
            centres.append(centre)
            values.append(100 * float(np.mean(true <= bound)))
        lowest = min(lowest, *values)
        axes.plot(
            centres,
            values,
            marker="o",
            markersize=4,
            color=SPARE_COLOURS[i % len(SPARE_COLOURS)],
            label=f"{promised:.0%}, {indicator}",
        )
    axes.set(title="Bound on the largest error held, %", ylim=(lowest - 4, 102))
    if bound_kinds(samples):
        axes.legend(loc="lower left", fontsize=8)


def _draw_sharpness(axes: Axes, samples: Sequence[BarSample]) -> None:
    every = [1.0]
    for i, (indicator, promised) in enumerate(bound_kinds(samples)):
        centres, values = [], []
        for centre, some in _binned(samples):
            true, bound = bound_pairs(some, indicator, promised)[..., 1].T
            centres.append(centre)
            values.append(float(np.median(bound / true)))
        every += values
        paint = SPARE_COLOURS[i % len(SPARE_COLOURS)]
        axes.plot(centres, values, marker="o", markersize=4, color=paint)
    axes.axhline(1.0, color=axes.xaxis.label.get_color(), linewidth=1)
    axes.set_title("Bound over true largest error, median")
    _ratio_axis(axes, every)


def _binned(
    samples: Sequence[BarSample],
) -> list[tuple[float, list[BarSample]]]:
    """Return (middle of the loads in %, samples) of every bin that has some."""
    bins: list[list[BarSample]] = [[] for _ in range(BINS)]
    for sample in samples:
        bins[min(int(sample.load_factor * BINS - 1e-9), BINS - 1)].append(sample)
    return [
        (100 * float(np.mean([s.load_factor for s in some])), some)
        for some in bins
        if some
    ]


def _ratio_axis(axes: Axes, values: Sequence[float]) -> None:
    axes.set_yscale("log")
    axes.set_yticks(RATIOS)  # moves the limits
    axes.set_ylim(min(0.4, 0.9 * min(values)), max(2.5, 1.1 * max(values)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
