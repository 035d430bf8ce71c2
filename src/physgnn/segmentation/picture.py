"""A picture to judge a segmentation by: outlines over the scan in three planes."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.regions import REGIONS
from physgnn.segmentation.orientation import mask_on, upright

COLOURS = {1: "tab:orange", 2: "red", 3: "tab:cyan"}
# Index axis normal to the plane; the others run right and up.
PLANES = {"sagittal": 0, "coronal": 1, "axial": 2}
SIDES = {"sagittal": "PA", "coronal": "LR", "axial": "LR"}  # left and right of a panel
PANEL_INCHES, PER_CENT = 3.4, (1.0, 99.5)


def outlines(image: Image, labels: LabelVolume, title: str) -> Figure:
    """Draw two slices of each plane: one through the tumour or the middle, one beside.

    Parameters
    ----------
    image : Image
        The scan.
    labels : LabelVolume
        As `physgnn.segmentation.scan_labels` returns it, on the same voxels.
    title : str
        A line above, such as the volumes.
    """
    cubes = upright(image)
    masks = {
        label: mask_on(cubes.grid, labels.data == label, labels.affine)
        for label in COLOURS
        if (labels.data == label).any()
    }
    whole = mask_on(cubes.grid, labels.data != 0, labels.affine)
    masks[1] = whole
    shown = masks.get(2, masks.get(3, whole))
    centre = np.rint(np.argwhere(shown).mean(axis=0)).astype(int)
    grey = np.asarray(cubes.data, dtype=np.float64)
    low, high = np.percentile(grey[whole], PER_CENT)
    figure = Figure(figsize=(3 * PANEL_INCHES, 2 * PANEL_INCHES + 0.5))
    axes = figure.subplots(2, 3)
    for column, (name, axis) in enumerate(PLANES.items()):
        for row, beside in enumerate((0.0, 15.0)):
            step = round(beside / float(cubes.grid.voxel_mm[axis]))
            at = min(int(centre[axis]) + step, whole.shape[axis] - 1)
            panel = axes[row, column]
            panel.imshow(
                np.take(grey, at, axis).T,
                cmap="gray",
                origin="lower",
                vmin=low,
                vmax=max(high, low + 1e-6),
            )
            for label, mask in masks.items():
                part = np.take(mask, at, axis).T
                if part.any() and not part.all():
                    panel.contour(part, [0.5], colors=COLOURS[label], linewidths=1.2)
            panel.set_title(f"{name}, {cubes.affine[axis, 3] + at:.0f} mm", fontsize=9)
            panel.set_axis_off()
            for at_x, side in zip((0.02, 0.94), SIDES[name], strict=True):
                panel.text(
                    at_x,
                    0.5,
                    side,
                    color="white",
                    fontsize=8,
                    transform=panel.transAxes,
                )
    handles = [
        Line2D([], [], color=COLOURS[label], label=REGIONS[label - 1])
        for label in sorted(masks)
    ]
    figure.legend(handles=handles, loc="lower center", ncols=3, frameon=False)
    figure.suptitle(title, fontsize=10)
    return figure
