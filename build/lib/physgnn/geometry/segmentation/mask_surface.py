"""One mask to one smooth, evenly meshed surface of the same volume.

The mask's signed distance interpolates between slices by shape (Raya and Udupa, IEEE
Trans. Med. Imaging 9, 1990), so thick slices leave no steps. Smoothing it shrinks what
is convex; the level is therefore chosen that holds as many voxels as the mask, and the
triangles are moved out by what they cut off.
"""

import warnings

import numpy as np
import pyacvd
import pyvista as pv
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import marching_cubes

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.normals import vertex_normals
from physgnn.geometry.surface import Surface, volume
from physgnn.geometry.surfaces.repair import repaired

LevelSet = NDArray[np.float32]

FINE_PER_EDGE = 3.0  # steps of the fine surface along an edge of the even one
FINE_PER_POINT = 8  # its points for every even one, which the clustering needs
VOLUME_TOLERANCE = 1e-4
LEAST_LEVEL = 1e-2  # mm between the level and a voxel's centre


def level_set(mask: BoolArray, grid: ImageGrid, smoothing_mm: float) -> LevelSet:
    """Return a smooth signed distance in mm, negative inside.

    As many voxels are negative as the mask has.

    Parameters
    ----------
    mask : boolean array
        The tissue; its voxels are those of the grid.
    grid : ImageGrid
        Voxel sizes.
    smoothing_mm : float
        Standard deviation of the Gaussian.
    """
    spacing = grid.voxel_mm
    outside = ndimage.distance_transform_edt(~mask, sampling=spacing)
    distance = outside - ndimage.distance_transform_edt(mask, sampling=spacing)
    smooth = ndimage.gaussian_filter(
        distance.astype(np.float32), smoothing_mm / spacing, mode="nearest"
    )
    n_inside = int(mask.sum())
    lower, upper = np.partition(smooth, (n_inside - 1, n_inside), axis=None)[
        n_inside - 1 : n_inside + 1
    ]
    level: LevelSet = smooth - (lower + upper) / 2
    return level


def parts_of(
    mask: BoolArray, grid: ImageGrid, smoothing_mm: float, smallest_mm3: float
) -> list[BoolArray]:
    """Return the parts of a piece that smoothing takes apart, else the piece itself.

    Every voxel goes to the nearest part of at least the smallest volume.
    """
    pad = np.ceil(3.0 * smoothing_mm / grid.voxel_mm).astype(int) + 1
    used = np.argwhere(mask)
    low = np.maximum(used.min(axis=0) - pad, 0)
    window = tuple(map(slice, low, used.max(axis=0) + pad + 1))
    distance = level_set(mask[window], grid, smoothing_mm)
    part, _ = ndimage.label(distance < 0)
    size = np.bincount(part.ravel())[1:] * grid.voxel_volume_mm3
    numbers = np.flatnonzero(size >= smallest_mm3) + 1
    if len(numbers) < 2:
        return [mask]
    nearest = ndimage.distance_transform_edt(
        ~np.isin(part, numbers),
        grid.voxel_mm,
        return_distances=False,
        return_indices=True,
    )
    owner = part[tuple(nearest)]
    found = []
    for number in numbers[np.argsort(-size[numbers - 1], kind="stable")]:
        whole = np.zeros_like(mask)
        whole[window] = mask[window] & (owner == number)
        found.append(whole)
    return found


def even_surface(distance: LevelSet, grid: ImageGrid, edge_mm: float) -> Surface:
    """Cover the zero level with even triangles that enclose the same volume.

    Parameters
    ----------
    distance : (nx, ny, nz) array
        As `level_set` makes it.
    grid : ImageGrid
        Where its voxels are.
    edge_mm : float
        Length of an edge.

    Returns
    -------
    Surface
        Closed, one piece, outward.

    Raises
    ------
    InputError
        If nothing is left of the tissue, or the triangles cannot be repaired.
    """
    n_inside = _n_inside(distance)
    fine = _fine_surface(distance, grid, edge_mm)
    n_points = max(int(fine.area / (np.sqrt(0.75) * edge_mm**2)), 40)
    surface = repaired(Surface(*_faces(_even(fine, n_points))), "its even triangles")
    return with_volume(surface, n_inside * grid.voxel_volume_mm3)


def stepped_surface(distance: LevelSet, grid: ImageGrid) -> Surface:
    """Cover the zero level with the triangles of marching cubes, as they are.

    They are uneven and many, but cannot cross: each lies in a cube of voxels of its
    own. It is what is left where even triangles do not do.

    Raises
    ------
    InputError
        If nothing is left of the tissue.
    """
    _n_inside(distance)
    # a level through a voxel's very centre collapses faces
    apart = np.where(np.abs(distance) < LEAST_LEVEL, LEAST_LEVEL, distance)
    surface = Surface(*_faces(_fine_surface(apart, grid, 0.0)))
    return surface if volume(surface) > 0 else surface.flipped()


def _n_inside(distance: LevelSet) -> int:
    n_inside = int((distance < 0).sum())
    if n_inside < 8:
        raise InputError(
            "nothing is left of a tissue after smoothing and keeping it apart from the "
            "others: lower smoothing_mm, or leave its label out"
        )
    return n_inside


def with_volume(surface: Surface, target_mm3: float) -> Surface:
    """Move every point along its normal by one distance, for a wanted volume."""
    for _ in range(10):
        missing = target_mm3 - volume(surface)
        if abs(missing) < VOLUME_TOLERANCE * target_mm3:
            break
        poly = pv.PolyData.from_regular_faces(surface.points, surface.faces.astype(int))
        shift = missing / poly.area * vertex_normals(surface)
        surface = Surface(surface.points + shift, surface.faces)
    return surface


def _fine_surface(distance: LevelSet, grid: ImageGrid, edge_mm: float) -> pv.PolyData:
    step = max(int(edge_mm / FINE_PER_EDGE / grid.voxel_mm.max()), 1)
    index, faces, _, _ = marching_cubes(  # type: ignore[no-untyped-call]
        distance, 0.0, step_size=step
    )
    fine = pv.PolyData.from_regular_faces(grid.to_world(index), faces)
    largest: pv.PolyData = fine.connectivity("largest")
    return largest


def _even(fine: pv.PolyData, n_points: int) -> pv.PolyData:
    """Cluster the fine surface's points into even cells (Valette et al., 2008)."""
    with warnings.catch_warnings():
        # pyacvd 0.4 reads an attribute that PyVista renamed
        warnings.filterwarnings("ignore", category=pv.PyVistaDeprecationWarning)
        clusters = pyacvd.Clustering(fine)
        short = FINE_PER_POINT * n_points / fine.n_points
        if short > 1:
            clusters.subdivide(int(np.ceil(np.log(short) / np.log(4))))
        clusters.cluster(n_points)
        coarse: pv.PolyData = clusters.create_mesh()
    return coarse


def _faces(poly: pv.PolyData) -> tuple[FloatArray, NDArray[np.int32]]:
    points = np.asarray(poly.points, dtype=np.float64)
    return points, poly.regular_faces.astype(np.int32)
