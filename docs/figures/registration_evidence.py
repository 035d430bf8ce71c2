"""How far a measured place is trusted, by how far off it is."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from physgnn.registration.inference.heavy_tails import (
    OUTLIER_WEIGHT,
    student_weights,
)

mpl.use("Agg")
mpl.rcParams["svg.hashsalt"] = "physgnn"
from matplotlib import pyplot as plt  # noqa: E402

off = np.linspace(0.0, 12.0, 241)
figure, axes = plt.subplots(figsize=(6.0, 2.6), layout="constrained")
for k, name in ((3, "a pair: three components"), (1, "a surface: one")):
    square = np.zeros((len(off), k))
    square[:, 0] = off**2
    axes.plot(off, student_weights(square.ravel(), ((len(off), k),)), label=name)
axes.axhline(OUTLIER_WEIGHT, color="grey", linewidth=0.8, linestyle="--")
axes.text(8.0, OUTLIER_WEIGHT + 0.03, "below: an outlier", color="grey")
axes.set(xlabel="distance over the stated noise", ylabel="weight", ylim=(0, None))
axes.legend(frameon=False)
figure.savefig(
    Path(__file__).parents[1] / "images" / "registration_evidence.svg",
    metadata={"Date": None},
)
