"""The displacement on an image grid, forward and inverse.

The finite elements move rest points X to x = X + u(X). An image is resampled the other
way: its deformed version at x shows what was at X. On each tetrahedron the map is
affine, so its inverse is that of the deformed tetrahedron, exactly.

Outside of the brain, where there are no elements, the displacement of the nearest voxel
of brain fades to zero along a straight line over `fade_mm`.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from physgnn.arrays import BoolArray, FloatArray
from physgnn.errors import InputError
from physgnn.geometry.image import ImageGrid
from physgnn.geometry.tetmesh import TetMesh
from physgnn.imaging.voxel_fields import rasterize

# The fade's slope is then at most a quarter, so that it cannot fold by itself.
FADE_PER_DISPLACEMENT, SHORTEST_FADE_MM = 4.0, 10.0


@dataclass(frozen=True, eq=False)
class DisplacementField:
    """A displacement at every voxel.

    Attributes
    ----------
    vectors : (nx, ny, nz, 3) array
        mm, world axes RAS+.
    grid : ImageGrid
        Where the voxels are.
    inside : (nx, ny, nz) boolean array
        Where there is brain; elsewhere the vectors fade to zero.
    direction : str
        "forward": at rest points X, u = x − X. "inverse": at deformed points x,
        v = X − x, which is what resampling needs.
    fade_mm : float
        Over which the vectors fade.
    """

    vectors: FloatArray
    grid: ImageGrid
    inside: BoolArray
    direction: Literal["forward", "inverse"]
    fade_mm: float


def forward_field(
    mesh: TetMesh,
    displacement: FloatArray,
    grid: ImageGrid,
    *,
    fade_mm: float | None = None,
) -> DisplacementField:
    """Return u at the voxels of the rest state.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    displacement : (n_points, 3) array
        mm.
    grid : ImageGrid
        Where to sample.
    fade_mm : float, optional
        By default four times the largest displacement, and 10 mm at least.

    Returns
    -------
    DisplacementField
        u at each voxel, mm RAS.

    Raises
    ------
    InputError
        If the displacement does not fit the mesh, or mesh and grid do not meet.
    """
    u = checked_displacement(mesh, displacement)
    vectors, cell = rasterize(mesh.points, mesh.cells, u, grid)
    return _extended(vectors, cell >= 0, grid, "forward", fade_length(u, fade_mm))


def inverse_field(
    mesh: TetMesh,
    displacement: FloatArray,
    grid: ImageGrid,
    *,
    fade_mm: float | None = None,
) -> DisplacementField:
    """Return v = X − x at the voxels of the deformed state; see `forward_field`.

    Parameters
    ----------
    mesh : TetMesh
        The rest state; mm.
    displacement : (n_points, 3) array
        u of each point of the mesh, mm.
    grid : ImageGrid
        Voxels to sample at, RAS.
    fade_mm : float, optional
        See `forward_field`.

    Returns
    -------
    DisplacementField
        v at each voxel, mm RAS: what resampling an image takes.
    """
    u = checked_displacement(mesh, displacement)
    vectors, cell = rasterize(mesh.points + u, mesh.cells, -u, grid)
    return _extended(vectors, cell >= 0, grid, "inverse", fade_length(u, fade_mm))


def grid_around(
    mesh: TetMesh, *, spacing_mm: float = 2.0, margin_mm: float = 30.0
) -> ImageGrid:
    """Return an RAS grid that holds a mesh with a margin, for want of an image.

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.
    spacing_mm : float
        Edge of a voxel.
    margin_mm : float
        Between the mesh and the first and last voxel, on each axis.

    Returns
    -------
    ImageGrid
        Shape and affine of the voxels.
    """
    low = mesh.points.min(axis=0) - margin_mm
    high = mesh.points.max(axis=0) + margin_mm
    shape = np.ceil((high - low) / spacing_mm).astype(int) + 1
    affine = np.diag([spacing_mm, spacing_mm, spacing_mm, 1.0])
    affine[:3, 3] = low
    return ImageGrid(tuple(shape), affine)


def round_trip_mm(forward: DisplacementField, inverse: DisplacementField) -> FloatArray:
    """Return how far X + u(X) lands from x, for every voxel x of deformed brain.

    u is interpolated linearly between voxels, as every program that reads the field
    does. Voxels whose X has a neighbour without brain are left out: there it is the
    extension that counts.

    Parameters
    ----------
    forward : DisplacementField
        u at the voxels of the rest state, mm.
    inverse : DisplacementField
        v at the voxels of the deformed state, mm.

    Returns
    -------
    (n_voxels,) array
        Distances, mm.
    """
    from scipy import ndimage

    inside = inverse.inside
    x = inverse.grid.to_world(np.argwhere(inside))
    X = x + inverse.vectors[inside]
    index = forward.grid.to_index(X).T
    complete = ndimage.map_coordinates(
        forward.inside.astype(np.float32), index, order=1, mode="constant"
    )
    kept = complete > 1.0 - 1e-6
    u = np.stack(
        [
            ndimage.map_coordinates(forward.vectors[..., i], index[:, kept], order=1)
            for i in range(3)
        ],
        axis=1,
    )
    error: FloatArray = np.linalg.norm(X[kept] + u - x[kept], axis=1)
    return error


def _extended(
    vectors: FloatArray,
    inside: BoolArray,
    grid: ImageGrid,
    direction: Literal["forward", "inverse"],
    fade_mm: float,
) -> DisplacementField:
    from scipy import ndimage

    if not inside.any():
        raise InputError(
            "mesh and image do not meet: check that both are in the same world "
            "coordinates, mm"
        )
    distance, nearest = ndimage.distance_transform_edt(
        ~inside, sampling=grid.voxel_mm, return_indices=True
    )
    near = ~inside & (distance < fade_mm)
    weight = 1.0 - distance[near] / fade_mm
    vectors[near] = weight[:, None] * vectors[tuple(nearest[:, near])]
    return DisplacementField(vectors, grid, inside, direction, fade_mm)


def checked_displacement(mesh: TetMesh, displacement: FloatArray) -> FloatArray:
    """Return a displacement in double precision; InputError if it fits no mesh."""
    u = np.asarray(displacement, dtype=np.float64)
    if u.shape != mesh.points.shape or not np.isfinite(u).all():
        raise InputError(
            f"the displacement must be finite, one vector a point, {mesh.points.shape} "
            f"(got {u.shape})"
        )
    return u


def fade_length(u: FloatArray, fade_mm: float | None = None) -> float:
    """Return over how far a displacement fades outside of the brain, mm.

    Raises
    ------
    InputError
        If `fade_mm` is given and not > 0.
    """
    if fade_mm is None:
        largest = float(np.linalg.norm(u, axis=1).max())
        return max(FADE_PER_DISPLACEMENT * largest, SHORTEST_FADE_MM)
    if not 0 < fade_mm < np.inf:
        raise InputError(f"fade_mm must be > 0 (got {fade_mm})")
    return fade_mm
