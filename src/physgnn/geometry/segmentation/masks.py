"""Label maps to clean masks: closed, without holes, islands or contact.

The brain's mask holds everything within it, so that the masks nest. Whatever is
changed is said, in ml.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid, LabelVolume
from physgnn.geometry.regions import REGIONS
from physgnn.geometry.segmentation.labels.label_table import LabelTable
from physgnn.geometry.segmentation.labels.naming import (
    piece_names,
    structure_names,
    structures,
)
from physgnn.geometry.segmentation.mask_surface import parts_of

Mask = BoolArray

# A second piece of brain larger than this fraction of the first is no speck.
SPECK = 0.05
# More of a tissue than this fraction outside of the brain is no stray voxels.
LARGEST_APART = 0.5
# More than this of the brain in pieces of a tissue below the smallest are no noise.
MOST_TOO_SMALL = 0.02
# A brain that only touches the image's border has about one cap of a sphere there, a
# brain stem less; one that is cut off has more.
CAPS = 3.0
MARGIN_MM = 10.0  # of background around the brain
SMALLEST_MM3 = 200.0  # smaller pieces are mostly noise of the segmentation
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
    names : tuple of str
        What messages call the tumours, then the ventricles.
    structure : integer array
        Which ventricle a voxel belongs to: from 1 on in the order of
        ``structure_names``, 0 for none that has a name.
    structure_names : tuple of str
        Such as "third ventricle"; a ventricle of one piece may hold several.
    notes : tuple of str
        What was repaired.
    """

    grid: ImageGrid
    brain: Mask
    tumours: tuple[Mask, ...]
    ventricles: tuple[Mask, ...]
    names: tuple[str, ...]
    structure: NDArray[np.int32]
    structure_names: tuple[str, ...]
    notes: tuple[str, ...]


def tissue_masks(
    labels: LabelVolume,
    table: LabelTable,
    *,
    closing_mm: float | None = None,
    smallest_mm3: float = SMALLEST_MM3,
    smoothing_mm: float = 0.0,
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
    smoothing_mm : float
        What smoothing over this length takes apart is cut there, at its thin places, so
        that no large part is lost.

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
    window, grid = _window(whole, labels.grid, MARGIN_MM + closing)
    notes: list[str] = []
    _check_border(whole, labels.grid, notes)
    voxel = grid.voxel_volume_mm3
    cropped = _cropped(labels.data, window)
    brain = _closed(_cropped(whole, window), grid.voxel_mm, closing, voxel, notes)
    notes += _folds(brain & ~_cropped(whole, window), cropped, table)
    for name in REGIONS[1:]:
        if name in masks:
            _check_apart(_cropped(masks[name], window), brain, name, voxel, notes)
    parts: dict[str, tuple[Mask, ...]] = dict.fromkeys(REGIONS[1:], ())
    names: list[str] = []
    for name in REGIONS[1:]:
        if name in masks:
            mask = _cropped(masks[name], window) & brain
            pieces = _pieces(mask, name, smallest_mm3, voxel, notes)
            _check_kept(mask, pieces, brain, name, voxel)
            parts[name] = tuple(
                part
                for piece in pieces
                for part in parts_of(piece, grid, smoothing_mm, smallest_mm3)
            )
            if len(parts[name]) > len(pieces):
                notes.append(
                    f"{name}: {len(pieces)} pieces cut where they are thin, into "
                    f"{len(parts[name])}"
                )
        names += piece_names(parts[name], cropped, table, name)
    return TissueMasks(
        grid,
        brain,
        parts["tumour"],
        parts["ventricle"],
        names=tuple(names),
        structure=structures(cropped, table),
        structure_names=structure_names(table),
        notes=tuple(notes),
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


def _cropped(mask: NDArray[Any], window: Window) -> NDArray[Any]:
    """Return the part of an array in a window, 0 where the image ends."""
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
        what = f"brain: folds narrower than {2 * radius:g} mm (closing_mm {radius:g}):"
        _note(notes, what, mask.sum() - size, voxel, "filled")
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
        islands = "1 island" if n_pieces == 2 else f"{n_pieces - 1} islands"
        _note(notes, f"brain: {islands} dropped,", dropped, voxel)
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
    n_small = len(sizes) - len(large)
    pieces = "1 piece" if n_small == 1 else f"{n_small} pieces"
    what = f"{name}: {pieces} below {smallest:g} mm³ dropped,"
    _note(notes, what, small, voxel)
    kept = [np.asarray(ndimage.binary_fill_holes(piece == i + 1)) for i in large]
    holes = sum(int(k.sum()) for k in kept) - sizes[large].sum()
    _note(notes, f"{name}: holes filled,", holes, voxel)
    return tuple(kept)


def _check_kept(
    mask: Mask, pieces: tuple[Mask, ...], brain: Mask, name: str, voxel: float
) -> None:
    """Refuse to take for brain, as too small, a tissue that is much of the brain."""
    size, lost = (
        int(mask.sum()),
        int(mask.sum() - sum((p & mask).sum() for p in pieces)),
    )
    if lost > MOST_TOO_SMALL * brain.sum():
        raise InputError(
            f"the {name} must have pieces worth meshing ({lost * voxel / 1000:.3g} of "
            f"its {size * voxel / 1000:.3g} ml are in smaller ones): check the label "
            "map, or give a smaller --smallest-mm3 (smallest_mm3=…)"
        )


def _check_border(whole: Mask, grid: ImageGrid, notes: list[str]) -> None:
    """Note where the image ends within the brain, not at its surface."""
    sizes = grid.voxel_mm
    radius = float((3.0 * whole.sum() * sizes.prod() / (4.0 * np.pi)) ** (1 / 3))
    for axis in range(3):
        face = float(sizes.prod() / sizes[axis])
        cap = 2.0 * np.pi * radius * sizes[axis]  # of a sphere that touches, mm²
        for name, end in (("first", 0), ("last", -1)):
            cut = float(whole.take(end, axis).sum()) * face
            if cut > CAPS * cap:
                notes.append(
                    f"brain: {cut / 100:.0f} cm² of it at the image's border, {name} "
                    f"slice of axis {axis}: check that it is not cut off there"
                )


def _folds(
    filled: Mask, labels: NDArray[np.int32], table: LabelTable
) -> tuple[str, ...]:
    """Say how much of what was filled a map that labels the fluid has as outside."""
    outside = (
        float(np.isin(labels[filled], table.outside).mean()) if filled.any() else 0
    )
    if outside == 0.0:
        return ()
    return (f"brain: of what was filled the map labels {outside:.0%} as outside of it",)


def _note(
    notes: list[str], what: str, voxels: int, voxel: float, done: str = ""
) -> None:
    if voxels > 0:
        notes.append(f"{what} {voxels * voxel / 1000:.2f} ml {done}".rstrip())
