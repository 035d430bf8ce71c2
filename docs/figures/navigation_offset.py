"""How far points of the bone tell an offset, by the distance from them."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from physgnn.geometry.measured import BonePoints
from physgnn.registration.inference.bone_offset import offset_from_bone

mpl.use("Agg")
mpl.rcParams["svg.hashsalt"] = "physgnn"
from matplotlib import pyplot as plt  # noqa: E402

NOISE_MM, RADIUS_MM = 0.5, 40.0


def ring(count: int, radius_mm: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    around = [np.cos(angle), np.sin(angle), np.zeros(count)]
    return radius_mm * np.stack(around, axis=1)


depth = np.linspace(0.0, 100.0, 51)
figure, axes = plt.subplots(figsize=(6.0, 2.8), layout="constrained")
for name, points in (
    ("3, within 10 mm", ring(3, 10.0)),
    ("3, around the craniotomy", ring(3, RADIUS_MM)),
    ("6, around the craniotomy", ring(6, RADIUS_MM)),
):
    found = offset_from_bone(BonePoints(points, points), NOISE_MM)
    roots = [found.prior_about(np.array([0.0, 0.0, -z])).axes for z in depth]
    spread = [np.sqrt(np.trace((root @ root.T)[:3, :3])) for root in roots]
    axes.plot(depth, spread, label=name)
axes.set_xlabel("depth below the middle of the points, mm")
axes.set_ylabel("offset unknown by, mm")
axes.set_ylim(0.0, 6.0)
axes.legend(title="bone points, 0.5 mm of noise", frameon=False)
axes.spines[["top", "right"]].set_visible(False)
figure.savefig(
    Path(__file__).parents[1] / "images" / "navigation_offset.svg",
    metadata={"Date": None},
)
