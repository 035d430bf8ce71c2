"""Slices before and after, and a checkerboard of both."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.geometry.image import Image, LabelVolume
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.field import grid_around, inverse_field
from physgnn.imaging.image_warping import warp
from physgnn.imaging.labels import deformed_labels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SQUARE_MM = 20.0
PANEL_INCHES = 3.2
OPACITY = 0.65  # of colours over grey
FADES_BELOW = 0.2  # of the range of colours
LABEL_MM = 1.0  # voxels of the label map drawn for want of an image
# Index axis normal to the plane, and which others run right and up.
PLANES = {"sagittal": (0, 1, 2), "coronal": (1, 0, 2), "axial": (2, 0, 1)}


def before_after(before: Image, after: Image, centre_mm: ArrayLike) -> "Figure":
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
    from matplotlib.figure import Figure

    first, affine = _upright(before)
    second, _ = _upright(after)
    sizes = np.linalg.norm(affine[:3, :3], axis=0)
    middle = _voxel(affine, centre_mm, first.shape)
    low, high = _window(before)
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


@dataclass(frozen=True, eq=False)
class Overlay:
    """Values to lay over an image, on its grid.

    Attributes
    ----------
    values : (nx, ny, nz) array
        What is shown in colours.
    shown : (nx, ny, nz) boolean array
        Where.
    limits : (low, high)
        Where colours begin and end.
    colours : str
        Name of a colour map.
    title : str
        Of the colour bar, with the unit.
    fades : bool
        Whether the lowest values let the image through.
    """

    values: FloatArray
    shown: BoolArray
    limits: tuple[float, float]
    colours: str
    title: str
    fades: bool = False


def overlaid(image: Image, overlay: Overlay, centre_mm: ArrayLike) -> "Figure":
    """Draw three planes through a point with values in colours over them.

    Seen as in `before_after`.
    """
    from matplotlib.figure import Figure

    grey, affine = _upright(image)
    values, _ = _upright(Image(np.asarray(overlay.values), image.affine))
    shown, _ = _upright(Image(overlay.shown.astype(np.uint8), image.affine))
    sizes = np.linalg.norm(affine[:3, :3], axis=0)
    middle = _voxel(affine, centre_mm, grey.shape)
    low, high = _window(image)
    size = (3 * PANEL_INCHES, 1.1 * PANEL_INCHES)
    figure = Figure(figsize=size, layout="constrained")
    # one scale for all three
    extents = [grey.shape[right] * sizes[right] for _, right, _ in PLANES.values()]
    panels = figure.subplots(1, 3, width_ratios=extents)
    for axes, (plane, (normal, right, up)) in zip(panels, PLANES.items(), strict=True):
        a, b, c = (
            np.take(data, middle[normal], normal).T for data in (grey, values, shown)
        )
        where = {"origin": "lower", "aspect": float(sizes[up] / sizes[right])}
        axes.imshow(a, cmap="gray", vmin=low, vmax=high, **where)
        drawn = axes.imshow(
            np.ma.masked_where(c < 0.5, b),
            cmap=overlay.colours,
            vmin=overlay.limits[0],
            vmax=overlay.limits[1],
            alpha=_opacity(b, overlay),
            interpolation="nearest",
            **where,
        )
        axes.set_title(plane, fontsize=9)
        axes.axis("off")
    bar = figure.colorbar(drawn, ax=list(panels), label=overlay.title, shrink=0.85)
    if bar.solids is not None:
        bar.solids.set_alpha(1.0)
    return figure


def _opacity(values: FloatArray, overlay: Overlay) -> FloatArray:
    low, high = overlay.limits
    share = (values - low) / (FADES_BELOW * (high - low))
    return OPACITY * (
        np.clip(share, 0.0, 1.0) if overlay.fades else np.ones_like(share)
    )


def slices_of_shift(
    mesh: TetMesh, displacement: FloatArray, image: Image | None = None
) -> "Figure":
    """Draw a body before and after a shift, through the place that moves most.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        mm.
    image : Image, optional
        Of the rest state, such as the T1; without one the tissues are drawn.

    Returns
    -------
    Figure
        Of Matplotlib; the caller saves it.

    Raises
    ------
    InputError
        If mesh and image do not meet.
    """
    if image is None:
        grid = grid_around(mesh, spacing_mm=LABEL_MM, margin_mm=10.0)
        before: Image = deformed_labels(mesh, np.zeros_like(displacement), grid)
        after: Image = deformed_labels(mesh, displacement, grid)
    else:
        before = image
        after = warp(image, inverse_field(mesh, displacement, image.grid))
    return before_after(before, after, middle_of_shift(mesh, displacement))


def middle_of_shift(mesh: TetMesh, displacement: FloatArray) -> FloatArray:
    """Return a point where planes show a shift: halfway in from what moves most."""
    most = int(np.linalg.norm(displacement, axis=1).argmax())
    middle: FloatArray = (mesh.points[most] + mesh.points.mean(axis=0)) / 2
    return middle


def _window(image: Image) -> tuple[float, float]:
    """Return the values that are black and white."""
    data = np.asarray(image.data, dtype=np.float64)
    if isinstance(image, LabelVolume) or not (data > 0).any():
        return 0.0, float(max(data.max(), 1.0))
    low, high = np.percentile(data[data > 0], (1, 99.5))
    return float(low), float(high)


def _upright(image: Image) -> tuple[FloatArray, FloatArray]:
    """Return data and affine with the axes nearest to right, anterior and superior."""
    import nibabel as nib
    from nibabel.orientations import apply_orientation, io_orientation

    turn = io_orientation(image.affine)
    data = np.asarray(image.data, dtype=np.float64)
    affine = image.affine @ nib.orientations.inv_ornt_aff(turn, data.shape)
    return np.asarray(apply_orientation(data, turn)), np.asarray(affine)


def _voxel(
    affine: FloatArray, centre_mm: ArrayLike, shape: tuple[int, ...]
) -> IntArray:
    """Return the voxel nearest to a place."""
    index = np.linalg.solve(affine, np.append(np.asarray(centre_mm), 1.0))[:3]
    voxel: IntArray = np.clip(index.round().astype(int), 0, np.array(shape) - 1)
    return voxel


def _checkerboard(shape: tuple[int, ...], sizes: FloatArray) -> BoolArray:
    rows, columns = (
        np.arange(n) * size // SQUARE_MM for n, size in zip(shape, sizes, strict=True)
    )
    even: BoolArray = (rows[:, None] + columns[None, :]) % 2 == 0
    return even
