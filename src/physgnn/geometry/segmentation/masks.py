"""Label maps to clean masks: closed, without holes, islands or contact.

The brain's mask holds everything within it, so that the masks nest. Whatever is
changed is said, in ml.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.regions import REGIONS
from physgnn.geometry.segmentation.label_tables import LabelTable

Mask = BoolArray

# A second piece of brain larger than this fraction of the first is no speck.
SPECK = 0.05
# More of a tissue than this fraction outside of the brain is no stray voxels.
LARGEST_APART = 0.5
FACES = ndimage.generate_binary_structure(3, 1)


@dataclass(frozen=True, eq=False)
class TissueMasks:
    """Where each tissue is, on a grid cropped to the brain with a margin.

    Attributes
    ----------
    grid : ImageGrid
        Where the voxels are.
    brain : boolean array
        One piece without cavities; holds the tumours and ventricles.
    tumours, ventricles : tuple of boolean arrays
        One piece each.
    notes : tuple of str
        What was repaired.
    """

    grid: ImageGrid
    brain: Mask
    tumours: tuple[Mask, ...]
    ventricles: tuple[Mask, ...]
    notes: tuple[str, ...]


def tissue_masks(
    labels: LabelVolume,
    table: LabelTable,
    *,
    closing_mm: float | None = None,
    smallest_mm3: float = 200.0,
    margin_mm: float = 10.0,
) -> TissueMasks:
    """Separate the tissues of a label map.

    Parameters
    ----------
    labels : LabelVolume
        The segmentation.
    table : LabelTable
        What its labels mean.
    closing_mm : float, optional
        Instead of the table's.
    smallest_mm3 : float
        Tumours and ventricles below this are taken for brain.
    margin_mm : float
        Background around the brain.

    Raises
    ------
    InputError
        If there is no brain, or it is in several large pieces.
    """
    masks = {name: labels.mask(ids) for name, ids in table.labels.items()}
    if not masks["brain"].any():
        have = np.unique(labels.data).tolist()
        raise InputError(
            f"no voxel has a label of brain, {table.labels['brain'][:4]}… "
            f"(the labels are {have[:12]}): name them, such as brain={have[-1]}"
        )
    closing = table.closing_mm if closing_mm is None else closing_mm
    whole = np.logical_or.reduce(list(masks.values()))
    window, grid = _window(whole, labels.grid, margin_mm + closing)
    notes: list[str] = []
    voxel = grid.voxel_volume_mm3
    brain = _closed(_cropped(whole, window), grid.voxel_mm, closing, voxel, notes)
    for name in REGIONS[1:]:
        if name in masks:
            _check_apart(_cropped(masks[name], window), brain, name, voxel, notes)
    parts = {
        name: _pieces(
            _cropped(masks[name], window) & brain, name, smallest_mm3, voxel, notes
        )
        for name in REGIONS[1:]
        if name in masks
    }
    return TissueMasks(
        grid, brain, parts.get("tumour", ()), parts.get("ventricle", ()), tuple(notes)
    )


Window = tuple[tuple[int, int], ...]


def _window(mask: Mask, grid: ImageGrid, margin: float) -> tuple[Window, ImageGrid]:
    """Return first and last index of a box around a mask; it may leave the image."""
    pad = np.ceil(margin / grid.voxel_mm).astype(int) + 1
    used = [np.flatnonzero(mask.any(axis=(*{0, 1, 2} - {i},))) for i in range(3)]
    window = tuple(
        (int(u[0] - p), int(u[-1] + p + 1)) for u, p in zip(used, pad, strict=True)
    )
    affine = grid.affine.copy()
    affine[:3, 3] = grid.to_world(np.array([low for low, _ in window]))
    shape = tuple(high - low for low, high in window)
    return window, ImageGrid(shape, affine)  # type: ignore[arg-type]


def _cropped(mask: Mask, window: Window) -> Mask:
    """Return the part of a mask in a window, empty where the image ends."""
    kept = tuple(slice(max(low, 0), high) for low, high in window)
    missing = [
        (max(-low, 0), max(high - n, 0))
        for (low, high), n in zip(window, mask.shape, strict=True)
    ]
    return np.pad(mask[kept], missing)


def _closed(
    mask: Mask, spacing: FloatArray, radius: float, voxel: float, notes: list[str]
) -> Mask:
    """Return the largest piece with sulci closed and cavities filled."""
    size = mask.sum()
    if radius > 0:
        grown = ndimage.distance_transform_edt(~mask, sampling=spacing) <= radius
        mask = mask | (ndimage.distance_transform_edt(grown, sampling=spacing) > radius)
        _note(notes, "brain: closing filled", mask.sum() - size, voxel)
    piece, n_pieces = ndimage.label(mask, FACES)
    sizes = np.bincount(piece.ravel())[1:]
    largest = int(sizes.argmax())
    if n_pieces > 1 and np.partition(sizes, -2)[-2] > SPECK * sizes[largest]:
        raise InputError(
            f"the brain must be one piece (its largest are {sizes[largest] * voxel:.0f}"
            f" and {np.partition(sizes, -2)[-2] * voxel:.0f} mm³): name all labels of "
            "brain, or close the gap with a larger closing_mm"
        )
    kept = piece == largest + 1
    if n_pieces > 1:
        dropped = mask.sum() - kept.sum()
        _note(notes, f"brain: {n_pieces - 1} islands dropped,", dropped, voxel)
    filled = ndimage.binary_fill_holes(kept)
    _note(notes, "brain: holes filled,", filled.sum() - kept.sum(), voxel)
    return np.asarray(filled, dtype=bool)


def _check_apart(
    mask: Mask, brain: Mask, name: str, voxel: float, notes: list[str]
) -> None:
    """Note what lies on an island and went with it; refuse if that is most of it."""
    apart, size = int((mask & ~brain).sum()), int(mask.sum())
    if apart > LARGEST_APART * size:
        raise InputError(
            f"the {name} must lie in the brain ({apart * voxel / 1000:.2f} of its "
            f"{size * voxel / 1000:.2f} ml lie apart from it): name all labels of "
            "brain, or give the brain mask"
        )
    _note(notes, f"{name}: apart from the brain, so dropped with it,", apart, voxel)


def _pieces(
    mask: Mask, name: str, smallest: float, voxel: float, notes: list[str]
) -> tuple[Mask, ...]:
    """Return the pieces of a tissue, largest first, each without cavities."""
    piece, _ = ndimage.label(mask, FACES)
    sizes = np.bincount(piece.ravel())[1:]
    order = np.argsort(-sizes, kind="stable")
    large = [i for i in order if sizes[i] * voxel >= smallest]
    small = sizes.sum() - sizes[large].sum()
    what = f"{name}: {len(sizes) - len(large)} pieces below {smallest:g} mm³ dropped,"
    _note(notes, what, small, voxel)
    kept = [np.asarray(ndimage.binary_fill_holes(piece == i + 1)) for i in large]
    holes = sum(int(k.sum()) for k in kept) - sizes[large].sum()
    _note(notes, f"{name}: holes filled,", holes, voxel)
    return tuple(kept)


def _note(notes: list[str], what: str, voxels: int, voxel: float) -> None:
    if voxels > 0:
        notes.append(f"{what} {voxels * voxel / 1000:.2f} ml")
