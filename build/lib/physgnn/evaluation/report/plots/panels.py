"""The frame of a report's figures: panels side by side, colour bars, both themes."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure

from physgnn.evaluation.report.plots.scenes import Pixels
from physgnn.evaluation.report.style import THEMES
from physgnn.io.integrity.atomic import whole_file

DPI = 160
WIDTH, AROUND_PANELS = 9.6, 1.1  # inches; height of titles and colour bars


@dataclass(frozen=True)
class Picture:
    """A figure on disk.

    Attributes
    ----------
    name : str
        File name without theme and ending.
    caption : str
        What it shows, for readers and for screen readers.
    files : tuple of Path
        PNG for a light page, PNG for a dark page.
    """

    name: str
    caption: str
    files: tuple[Path, ...]


def side_by_side(
    images: tuple[Pixels, ...], titles: tuple[str, ...]
) -> tuple[Figure, list[Axes]]:
    """Return a figure with one image beside the other, their margins cut off."""
    cropped = _cropped(images)
    rows, columns = cropped[0].shape[:2]
    height = WIDTH / len(images) * rows / columns + AROUND_PANELS
    made = Figure(figsize=(WIDTH, height), layout="constrained")
    axes = [made.add_subplot(1, len(images), i + 1) for i in range(len(images))]
    for panel, image, title in zip(axes, cropped, titles, strict=True):
        panel.imshow(image)
        panel.set_title(title, loc="center")
        panel.axis("off")
    return made, axes


def _cropped(images: Iterable[Pixels]) -> list[Pixels]:
    """Cut the margins that are empty in every image, so that all keep one scale."""
    stack = np.stack(list(images))
    drawn = np.any(stack[..., 3] > 0, axis=0)
    rows, columns = (np.flatnonzero(np.any(drawn, axis=i)) for i in (1, 0))
    return list(stack[:, rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])


def colour_bar(
    figure: Figure,
    axes: list[Axes],
    colours: Colormap,
    limits: tuple[float, float],
    text: str,
) -> None:
    """Draw one colour bar below some panels, its upper end open.

    Parameters
    ----------
    figure : Figure
    axes : list of Axes
        The panels that it belongs to.
    colours : Colormap
    limits : (low, high)
        Values at its ends, in the unit that `text` names.
    text : str
        What the colours mean.
    """
    scale = ScalarMappable(Normalize(*limits), colours)
    figure.colorbar(
        scale,
        ax=axes,
        orientation="horizontal",
        label=text,
        extend="max",
        shrink=0.6 if len(axes) > 1 else 0.9,
        aspect=30 if len(axes) > 1 else 22,
        pad=0.03,
    )


def save_picture(
    name: str, caption: str, figure: Callable[[], Figure], folder: Path
) -> Picture:
    """Draw a figure once a theme and save it."""
    files = []
    for theme in THEMES:
        with mpl.rc_context(theme.settings()):
            file = folder / f"{name}_{theme.name}.png"
            with whole_file(file) as part:
                figure().savefig(part, dpi=DPI, transparent=True)
            files.append(file)
    return Picture(name, caption, tuple(files))
