"""The surfaces of a case, one inside the other and apart."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import numpy as np
from scipy import ndimage

from physgnn.arrays import BoolArray
from physgnn.geometry.segmentation.attempts import (
    BRAIN_DICE,
    TUMOUR_DICE,
    VENTRICLE_DICE,
    Wanted,
    sound_surface,
)
from physgnn.geometry.segmentation.mask_surface import LevelSet, level_set
from physgnn.geometry.segmentation.masks import TissueMasks
from physgnn.geometry.segmentation.volume_fit import (
    SurfaceFit,
    dice,
    enclosed_voxels,
    surface_fit,
)
from physgnn.geometry.surface import Surface

# Edges along the radius of the smallest piece: a tumour of 11 mm gets edges of 3.7 mm.
EDGES_PER_RADIUS = 3.0
# Tissue kept between two surfaces, in voxels and in edges of the finer one: the even
# triangles may cut so far into folds.
GAP_VOXELS, GAP_EDGES = 1.0, 0.25
ROOM = 0.03  # of Dice, for triangles against voxels
# A structure of fewer voxels has no Dice that says anything.
LEAST_VOXELS = 50


class Nest:
    """Level sets of a case, each kept apart from those before it.

    Parameters
    ----------
    masks : TissueMasks
        The tissues.
    smoothing : float
        Standard deviation of the smoothing, mm.
    edge : float
        Edge of the brain's triangles, mm; smaller pieces get smaller ones.
    brain_dice : float
        How closely the brain's surface shall follow its mask.
    """

    def __init__(
        self,
        masks: TissueMasks,
        smoothing: float,
        edge: float,
        *,
        brain_dice: float = BRAIN_DICE,
    ) -> None:
        self._brain_dice = brain_dice
        self._masks, self._smoothing, self._edge = masks, smoothing, edge
        self._brain = level_set(masks.brain, masks.grid, smoothing)
        self._others: list[LevelSet] = []
        self._made: tuple[list[Surface], list[str]] = ([], [])
        self.fits: dict[str, SurfaceFit] = {}
        self.notes = list(masks.notes)

    def surfaces(
        self,
    ) -> tuple[Surface, tuple[Surface, ...], tuple[Surface, ...], "Nest"]:
        """Return brain, tumours, ventricles and self; those before take precedence."""
        masks = self._masks
        wanted = Wanted("brain", self._edge, self._smoothing, self._brain_dice)
        level = partial(level_set, masks.brain, masks.grid)
        brain = self._add(wanted, level, masks.brain)
        pieces = [(mask, TUMOUR_DICE) for mask in masks.tumours]
        pieces += [(mask, VENTRICLE_DICE) for mask in masks.ventricles]
        inner = [
            self._inner(mask, name, least)
            for (mask, least), name in zip(pieces, masks.names, strict=True)
        ]
        n = len(masks.tumours)
        return brain, tuple(inner[:n]), tuple(inner[n:]), self

    def _inner(self, mask: BoolArray, name: str, least: float) -> Surface:
        grid = self._masks.grid
        radius = np.cbrt(0.75 / np.pi * mask.sum() * grid.voxel_volume_mm3)
        edge = min(self._edge, float(radius) / EDGES_PER_RADIUS)
        gap = max(GAP_VOXELS * grid.voxel_mm.max(), GAP_EDGES * edge)

        @cache
        def level(smoothing: float) -> LevelSet:
            return self._apart(level_set(mask, grid, smoothing), gap)

        kept = level(self._smoothing)
        given = int(mask.sum()) - int((kept < 0).sum())
        if given > 0:
            self.notes.append(
                f"{name}: {given * grid.voxel_volume_mm3 / 1000:.2f} ml given "
                f"to the brain, to keep {gap:.1f} mm to the next surface"
            )
        # what is cut back to keep the surfaces apart cannot be followed
        least = min(least, dice(kept < 0, mask) - ROOM)
        surface = self._add(Wanted(name, edge, self._smoothing, least), level, mask)
        self._others.append(kept)
        return surface

    def _apart(self, distance: LevelSet, gap: float) -> LevelSet:
        """Return a level set cut back from the brain's surface and earlier pieces."""
        distance = np.maximum(distance, self._brain + gap)
        for other in self._others:
            distance = np.maximum(distance, gap - other)
        return distance

    def _add(
        self, wanted: Wanted, level: Callable[[float], LevelSet], mask: BoolArray
    ) -> Surface:
        grid, (surfaces, names) = self._masks.grid, self._made
        nearest = self._nearest_structure(mask) if surfaces else {}

        def fit(surface: Surface) -> SurfaceFit:
            found = surface_fit(surface, mask, grid)
            each = self._structure_dice(surface, mask, nearest)
            return replace(found, structures=each if len(each) > 1 else {})

        surface, found = sound_surface(wanted, level, grid, fit, (surfaces, names))
        if found.worst_dice < wanted.dice:
            self.notes.append(
                f"{wanted.name}: no surface follows the labels better than a Dice of "
                f"{found.worst_dice:.3f}; a larger target_points may"
            )
        self.fits[wanted.name] = found
        surfaces.append(surface)
        names.append(wanted.name)
        return surface

    def _nearest_structure(self, mask: BoolArray) -> dict[int, BoolArray]:
        """Return where each structure of a piece is the nearest, by its number."""
        structure = np.where(mask, self._masks.structure, 0)
        size = np.bincount(structure.ravel())
        numbers = [n for n in range(1, len(size)) if size[n] >= LEAST_VOXELS]
        if len(numbers) < 2:
            return {}
        known = np.isin(structure, numbers)
        index = ndimage.distance_transform_edt(
            ~known,
            self._masks.grid.voxel_mm,
            return_distances=False,
            return_indices=True,
        )
        nearest = structure[tuple(index)]
        return {n: nearest == n for n in numbers}

    def _structure_dice(
        self, surface: Surface, mask: BoolArray, nearest: dict[int, BoolArray]
    ) -> dict[str, float]:
        if not nearest:
            return {}
        inside = enclosed_voxels(surface, self._masks.grid)
        names = self._masks.structure_names
        return {
            names[n - 1]: dice(inside & near, mask & near)
            for n, near in nearest.items()
        }
