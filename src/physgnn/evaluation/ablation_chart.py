"""Validation loss over the number of replaced layers, as in the paper."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from physgnn.evaluation.style import LIGHT, SPARE_COLOURS
from physgnn.io.atomic import whole_file

DPI = 160


@dataclass(frozen=True)
class Point:
    """Losses of one kind of network, mm, one a seed."""

    dataset: int
    replaced: int
    losses: tuple[float, ...]


def draw_ablation(panels: Mapping[str, Sequence[Point]], path: Path) -> None:
    """Draw a panel an ablation: a line a dataset through the means, a band of spread.

    Parameters
    ----------
    panels : mapping of title to points
        What was tried.
    path : path
        PNG to write, whole or not at all.
    """
    with mpl.rc_context(LIGHT.settings()):
        figure = Figure(figsize=(4.8 * len(panels), 3.8), layout="constrained")
        all_axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, (title, points) in zip(all_axes, panels.items(), strict=True):
            _draw(axes, points)
            axes.set(xlabel=title, ylabel="validation loss, mm")
        all_axes[0].legend()
        with whole_file(path) as part:
            figure.savefig(part, dpi=DPI, facecolor="white")


def _draw(axes: Axes, points: Sequence[Point]) -> None:
    for dataset in sorted({point.dataset for point in points}):
        mine = [point for point in points if point.dataset == dataset]
        x = [point.replaced for point in mine]
        losses = [point.losses for point in mine]
        colour = SPARE_COLOURS[dataset]
        means = [np.mean(values) for values in losses]
        axes.plot(x, means, marker="o", color=colour, label=f"dataset {dataset}")
        low, high = ([f(values) for values in losses] for f in (min, max))
        axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
