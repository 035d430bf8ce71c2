"""Colours, labels and themes that every figure and table of the report shares."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import ListedColormap

from physgnn.learning.models import method_name

# Mid-tones that stand out on white and on near-black, and from each other for the
# colour-blind (after Okabe & Ito, 2008).
LABELS_AND_COLOURS = {
    "zero": ("Zero displacement", "#8b929c"),
    "linear": ("Linear solution", "#d9861a"),
    "interpolation": ("Level interpolation", "#a760bd"),
    "linear-regression": ("Linear regression", "#b08d57"),
    "decision-tree": ("Decision tree", "#8fb35c"),
    "random-forest": ("Random forest", "#4f7a28"),
    "svr": ("Support vector regression", "#5d7ec9"),
    "gpr": ("Gaussian process", "#7a9fd6"),
    "rbf": ("Radial basis functions", "#c77f94"),
    "pod-network": ("POD + small network", "#b5651d"),
    "extra-trees": ("Extremely random trees", "#6f9a37"),
    "mlp": ("Network per node", "#3fa7c9"),
    "meshgraphnet": ("MeshGraphNets", "#4b8f9c"),
    "transolver": ("Transolver", "#9c4b8f"),
    "cnn": ("Convolutional network", "#7b6fd0"),
    "rigid": ("Rigid motion", "#8a7a66"),
    "spline": ("Thin-plate spline", "#c2527a"),
    "register": ("Registration", "#0f9d7e"),
    "physgnn": ("PhysGNN", "#2f7fd6"),
    "lifted": ("Lifted network", "#0f9d7e"),
    "reduced": ("Reduced model", "#c2a500"),
    "galerkin": ("POD-Galerkin", "#8c6d9e"),
    "certified": ("Repaired", "#d4477e"),
    "repaired": ("Repaired", "#d4477e"),
    "finite-element": ("Finite elements", "#6b5b4b"),
}
SPARE_COLOURS = ("#d4477e", "#c2a500", "#5b6ee1", "#3fa7c9", "#7a5195")

BRAIN, TUMOUR, FIXED, LOADED = "#cfc7bf", "#8e44ad", "#2f7fd6", "#e4572e"
# Viridis without its darkest part, which would sink into a dark page.
DISPLACEMENT_MAP = ListedColormap(colormaps["viridis"](np.linspace(0.2, 1.0, 256)))
ERROR_MAP = colormaps["YlOrRd"]


@dataclass(frozen=True)
class Theme:
    """Ink and lines of a figure on a page of one brightness."""

    name: str
    ink: str
    muted: str
    grid: str

    def settings(self) -> Any:
        """Return Matplotlib's settings; the page shows through the background."""
        return {
            "font.family": "DejaVu Sans",
            "font.size": 10,
            "axes.titlesize": 11,
            "axes.titleweight": "bold",
            "axes.titlelocation": "left",
            "axes.titlepad": 10,
            "axes.facecolor": "none",
            "figure.facecolor": "none",
            "savefig.facecolor": "none",
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.edgecolor": self.muted,
            "axes.labelcolor": self.ink,
            "axes.grid": True,
            "axes.axisbelow": True,
            "grid.color": self.grid,
            "grid.linewidth": 0.8,
            "text.color": self.ink,
            "xtick.color": self.muted,
            "ytick.color": self.muted,
            "xtick.labelcolor": self.ink,
            "ytick.labelcolor": self.ink,
            "legend.frameon": False,
        }


LIGHT = Theme("light", ink="#1c2127", muted="#68717d", grid="#e4e7eb")
DARK = Theme("dark", ink="#e9ebee", muted="#9aa3ae", grid="#31373f")
THEMES = (LIGHT, DARK)


def label(name: str) -> str:
    """Return a predictor's name as people read it."""
    name = method_name(name)
    known = LABELS_AND_COLOURS.get(name)
    return known[0] if known else name.replace("_", " ")


def colour(name: str) -> str:
    """Return a predictor's colour, the same in every figure."""
    name = method_name(name)  # a report may be of an earlier version
    if name in LABELS_AND_COLOURS:
        return LABELS_AND_COLOURS[name][1]
    return SPARE_COLOURS[sum(name.encode()) % len(SPARE_COLOURS)]
