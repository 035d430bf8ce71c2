"""Validation loss over the number of replaced layers, as in the paper."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from physgnn.evaluation.report.style import LIGHT, SPARE_COLOURS
from physgnn.io.integrity.atomic import whole_file

DPI = 160


@dataclass(frozen=True)
class Point:
    """Losses of one kind of network, mm, one a seed."""

    dataset: int
    replaced: int
    losses: tuple[float, ...]


def draw_ablation(panels: Mapping[str, Sequence[Point]], path: Path) -> None:
    """Draw a column an ablation and a row a dataset: means, seeds, a band of spread.

    Parameters
    ----------
    panels : mapping of title to points
        What was tried.
    path : path
        PNG to write, whole or not at all.
    """
    datasets = sorted({point.dataset for points in panels.values() for point in points})
    with mpl.rc_context(LIGHT.settings()):
        size = 4.8 * len(panels), 3.2 * len(datasets)
        figure = Figure(figsize=size, layout="constrained")
        # A row has one scale, so that its ablations can be compared.
        grid = figure.subplots(
            len(datasets), len(panels), squeeze=False, sharey="row", sharex="col"
        )
        for row, dataset in zip(grid, datasets, strict=True):
            row[0].set_ylabel(f"dataset {dataset}: validation loss, mm")
            for axes, points in zip(row, panels.values(), strict=True):
                _draw(axes, [point for point in points if point.dataset == dataset])
        for axes, title in zip(grid[-1], panels, strict=True):
            axes.set_xlabel(title)
        with whole_file(path) as part:
            figure.savefig(part, dpi=DPI, facecolor="white")


def _draw(axes: Axes, points: Sequence[Point]) -> None:
    colour = SPARE_COLOURS[points[0].dataset]
    x = [point.replaced for point in points]
    losses = [point.losses for point in points]
    axes.plot(x, [np.mean(values) for values in losses], marker="o", color=colour)
    for place, values in zip(x, losses, strict=True):
        axes.plot([place] * len(values), values, ".", color=colour, alpha=0.5)
    low, high = ([f(values) for values in losses] for f in (min, max))
    axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
