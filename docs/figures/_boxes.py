"""Diagrams of boxes and arrows."""

from _common import GREY, plt
from matplotlib.patches import FancyBboxPatch


def canvas(width: float, height: float) -> tuple[plt.Figure, plt.Axes]:
    """Return an empty page, in units of its own size."""
    figure, axes = plt.subplots(figsize=(width, height))
    axes.set(xlim=(0, width), ylim=(0, height))
    axes.axis("off")
    return figure, axes


def box(
    axes: plt.Axes,
    x: float,
    y: float,
    text: str,
    colour: str,
    width: float = 1.5,
    height: float = 0.7,
) -> None:
    """Draw a box centred at (x, y)."""
    shape = FancyBboxPatch(
        (x - width / 2, y - height / 2), width, height,
        boxstyle="round,pad=0.02,rounding_size=0.08", fc=colour + "22", ec=colour, lw=1.4,
    )  # fmt: skip
    axes.add_patch(shape)
    axes.text(x, y, text, ha="center", va="center", fontsize=8.5)


def arrow(
    axes: plt.Axes, start: tuple[float, float], end: tuple[float, float], text: str = ""
) -> None:
    """Draw an arrow, with a word at its middle."""
    axes.annotate(
        "", end, start, arrowprops={"arrowstyle": "->", "color": GREY, "lw": 1.3}
    )
    if text:
        x, y = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
        axes.text(x, y + 0.09, text, ha="center", fontsize=7.5, color="#555b64")
