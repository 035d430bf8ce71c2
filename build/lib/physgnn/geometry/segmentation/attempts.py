"""A sound surface of a tissue, by attempts: even triangles first, finer where needed.

Even triangles may cross in thin places and cut off thin horns. Finer ones, of a level
set smoothed less, follow the labels more closely; the triangles of marching cubes are
left where none of them do.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.segmentation.mask_surface import (
    LevelSet,
    even_surface,
    stepped_surface,
)
from physgnn.geometry.segmentation.volume_fit import SurfaceFit
from physgnn.geometry.surface import Surface
from physgnn.geometry.surfaces.checks import check_nested, check_surface

# Edge and smoothing of each attempt, as fractions of what was asked for.
ATTEMPTS = (
    *((1.0, 1.0), (0.75, 1.0), (0.6, 0.7), (0.5, 0.5)),
    *((0.4, 0.5), (0.4, 0.25), (0.3, 0.25), (0.25, 0.0)),
)
SMALLEST_EDGE = 1.0  # of a voxel's largest side
# What is asked of a surface, with a little room: meshes sample it at other places.
BRAIN_DICE, TUMOUR_DICE, VENTRICLE_DICE = 0.96, 0.96, 0.93


@dataclass(frozen=True)
class Wanted:
    """What a surface must be.

    Attributes
    ----------
    name : str
        What messages call it.
    edge_mm, smoothing_mm : float
        Of the first attempt.
    dice : float
        An attempt that follows its labels less closely is followed by another.
    """

    name: str
    edge_mm: float
    smoothing_mm: float
    dice: float


def sound_surface(
    wanted: Wanted,
    level: Callable[[float], LevelSet],
    grid: ImageGrid,
    fit: Callable[[Surface], SurfaceFit],
    nested: tuple[Sequence[Surface], Sequence[str]],
) -> tuple[Surface, SurfaceFit]:
    """Return the first attempt that does, or the one that follows its labels best.

    Parameters
    ----------
    wanted : Wanted
        Its name and size.
    level : callable
        Signed distance in mm, kept apart from other tissues, for a smoothing in mm.
    grid : ImageGrid
        Where its voxels are.
    fit : callable
        Compares a surface with its labels.
    nested : surfaces, names
        The brain and those inside of it that are there already; the new one must not
        cross them.

    Raises
    ------
    InputError
        If nothing is left of the tissue.
    """
    best: tuple[Surface, SurfaceFit] | None = None
    first: InputError | None = None
    for i, (edge, smoothing) in enumerate([*ATTEMPTS, (0.0, 1.0)]):
        edge_mm = max(edge * wanted.edge_mm, SMALLEST_EDGE * grid.voxel_mm.max())
        last = i == len(ATTEMPTS)
        if last and best is not None:
            break
        try:
            distance = level(smoothing * wanted.smoothing_mm)
            made = (
                stepped_surface(distance, grid)
                if last
                else even_surface(distance, grid, edge_mm)
            )
            surface, _ = check_surface(made, wanted.name)
            _check_place(surface, wanted.name, nested)
        except InputError as error:
            first = first or error
            continue
        found = fit(surface)
        if best is None or found.worst_dice > best[1].worst_dice:
            best = (surface, found)
        if found.worst_dice >= wanted.dice:
            break
    if best is None:
        assert first is not None
        raise InputError(f"{wanted.name}: {first}")
    return best


def _check_place(
    surface: Surface, name: str, nested: tuple[Sequence[Surface], Sequence[str]]
) -> None:
    surfaces, names = nested
    if surfaces:
        check_nested(surfaces[0], [*surfaces[1:], surface], [*names[1:], name])
