"""Slices before and after, and a checkerboard of both."""

import nibabel as nib
import numpy as np
from matplotlib.figure import Figure
from nibabel.orientations import apply_orientation, io_orientation
from numpy.typing import ArrayLike, NDArray

from physgnn.geometry.image import FloatArray, Image

SQUARE_MM = 20.0
PANEL_INCHES = 3.2
# Index axis normal to the plane, and which others run right and up.
PLANES = {"sagittal": (0, 1, 2), "coronal": (1, 0, 2), "axial": (2, 0, 1)}


def before_after(before: Image, after: Image, centre_mm: ArrayLike) -> Figure:
    """Draw three planes through a point: before, after, and squares of each in turn.

    Parameters
    ----------
    before, after : Image
        On the same grid, such as a T1 and its warped version.
    centre_mm : (3,) array
        Where the planes meet, world coordinates.

    Returns
    -------
    Figure
        Seen from the front, above and the right, as a neurosurgeon has it in RAS: the
        patient's right is on the right.
    """
    first, affine = _upright(before)
    second, _ = _upright(after)
    sizes = np.linalg.norm(affine[:3, :3], axis=0)
    index = np.linalg.solve(affine, np.append(np.asarray(centre_mm), 1.0))[:3]
    middle = np.clip(index.round().astype(int), 0, np.array(first.shape) - 1)
    low, high = (
        np.percentile(first[first > 0], (1, 99.5)) if (first > 0).any() else (0, 1)
    )
    figure = Figure(figsize=(3 * PANEL_INCHES, 3 * PANEL_INCHES), layout="constrained")
    for row, (plane, (normal, right, up)) in zip(
        figure.subplots(3, 3), PLANES.items(), strict=True
    ):
        a, b = (np.take(data, middle[normal], normal).T for data in (first, second))
        squares = _checkerboard(a.shape, sizes[[up, right]])
        panels = {"before": a, "after": b, "checkerboard": np.where(squares, a, b)}
        for axes, (title, panel) in zip(row, panels.items(), strict=True):
            axes.imshow(
                panel,
                cmap="gray",
                vmin=low,
                vmax=high,
                origin="lower",
                aspect=float(sizes[up] / sizes[right]),
            )
            axes.set_title(f"{plane}, {title}", fontsize=9)
            axes.axis("off")
    return figure


def _upright(image: Image) -> tuple[FloatArray, FloatArray]:
    """Return data and affine with the axes nearest to right, anterior and superior."""
    turn = io_orientation(image.affine)
    data = np.asarray(image.data, dtype=np.float64)
    affine = image.affine @ nib.orientations.inv_ornt_aff(turn, data.shape)
    return np.asarray(apply_orientation(data, turn)), np.asarray(affine)


def _checkerboard(shape: tuple[int, ...], sizes: FloatArray) -> NDArray[np.bool_]:
    rows, columns = (
        np.arange(n) * size // SQUARE_MM for n, size in zip(shape, sizes, strict=True)
    )
    even: NDArray[np.bool_] = (rows[:, None] + columns[None, :]) % 2 == 0
    return even
