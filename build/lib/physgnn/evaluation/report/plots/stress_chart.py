"""Stress over stretch and over shear: what was measured, and what laws make of it."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from physgnn.evaluation.report.style import LIGHT, SPARE_COLOURS
from physgnn.io.integrity.atomic import whole_file
from physgnn.mechanics.materials.stress_curves import KINDS, SHEAR, StressCurve
from physgnn.mechanics.materials.table import Material

DPI = 160
SMOOTH = 101  # points of a law's line


def draw_stress(
    curves: Sequence[StressCurve], materials: Mapping[str, Material], path: Path
) -> None:
    """Draw curves as dots and laws as lines, with every law's errors in the legend.

    Parameters
    ----------
    curves : sequence of StressCurve
        What was measured.
    materials : mapping of name to Material
        The laws to draw over it.
    path : path
        PNG to write, whole or not at all.
    """
    axial = [curve for curve in curves if curve.kind != SHEAR]
    shear = [curve for curve in curves if curve.kind == SHEAR]
    panels = [
        (chosen, label)
        for chosen, label in ((axial, "stretch"), (shear, "amount of shear"))
        if chosen
    ]
    with mpl.rc_context(LIGHT.settings()):
        size = 4.6 * len(panels) + 0.4, 4.2
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, (chosen, label) in zip(grid, panels, strict=True):
            _draw(axes, chosen, materials)
            axes.set(xlabel=label, ylabel="nominal stress, kPa")
        handles, names = grid[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", fontsize=8)
        with whole_file(path) as part:
            figure.savefig(part, dpi=DPI, facecolor="white", format="png")


def errors_in_words(errors: Mapping[str, float]) -> str:
    """Return ``tension 5.2 %, compression 15.4 %``."""
    return ", ".join(f"{kind} {100 * error:.1f} %" for kind, error in errors.items())


def _draw(
    axes: Axes, curves: Sequence[StressCurve], materials: Mapping[str, Material]
) -> None:
    for i, curve in enumerate(curves):
        axes.plot(
            curve.amount,
            curve.stress_pa / 1e3,
            "o",
            color=LIGHT.muted,
            markersize=3.5,
            label="measured" if i == 0 else None,
        )
    for number, (name, material) in enumerate(materials.items()):
        paint = SPARE_COLOURS[number % len(SPARE_COLOURS)]
        style = "-" if number < len(SPARE_COLOURS) else "--"
        for i, curve in enumerate(curves):
            amount = np.linspace(curve.amount.min(), curve.amount.max(), SMOOTH)
            line = KINDS[curve.kind](material, amount)
            label = name if i == 0 else None
            axes.plot(
                amount, line / 1e3, style, color=paint, linewidth=1.8, label=label
            )
