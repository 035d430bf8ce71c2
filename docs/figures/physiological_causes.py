"""The four physiological causes of the prior, as sketches."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
mpl.rcParams["svg.hashsalt"] = "physgnn"
from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.patches import Circle, Rectangle  # noqa: E402

TISSUE, TUMOUR, GROWN, FLUID = "#e6d3c8", "#b4654a", "#d9861a", "#9cc3e0"
NAMES = ("gravity", "near-swelling", "brain-swelling", "collapse")

figure, panels = plt.subplots(1, 4, figsize=(9.0, 2.6), layout="constrained")
for axes, name in zip(panels, NAMES, strict=True):
    colour = GROWN if name == "brain-swelling" else TISSUE
    brain = Circle((0.0, 0.0), 1.0, facecolor=colour, edgecolor="black")
    axes.add_patch(brain)
    inner = "white" if name == "collapse" else TUMOUR
    if name == "near-swelling":
        axes.add_patch(Circle((0.2, 0.35), 0.5, facecolor=GROWN))
    if name == "gravity":
        fluid = Rectangle((-1.2, -1.2), 2.4, 1.3, facecolor=FLUID, alpha=0.6)
        axes.add_patch(fluid)
        for x in (-0.6, -0.2, 0.6):
            axes.annotate("", (x, 0.2), (x, 0.7), arrowprops={"arrowstyle": "->"})
    axes.add_patch(Circle((0.2, 0.35), 0.25, facecolor=inner, edgecolor="black"))
    if name == "collapse":
        for turn in np.linspace(0.0, 2 * np.pi, 6, endpoint=False):
            away = np.array([np.cos(turn), np.sin(turn)])
            middle = np.array([0.2, 0.35])
            axes.annotate(
                "",
                middle + 0.05 * away,
                middle + 0.5 * away,
                arrowprops={"arrowstyle": "->"},
            )
    axes.set(title=name, xlim=(-1.25, 1.25), ylim=(-1.25, 1.25), aspect="equal")
    axes.axis("off")
figure.savefig(
    Path(__file__).parents[1] / "images" / "physiological_causes.svg",
    facecolor="white",
    metadata={"Date": None},
)
