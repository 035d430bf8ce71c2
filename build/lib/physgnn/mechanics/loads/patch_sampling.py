"""Patch loads drawn at random: small and large, gentle and strong."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadPath
from physgnn.mechanics.loads.sampling import (
    by_position,
    equal_levels,
    inward_normals,
    within_cone,
)

Range = tuple[float, float]

PLATEAU = 0.5  # of the radius; a real instrument presses evenly up to near its rim


def patch_load_paths(
    mesh: TetMesh,
    loaded: IntArray,
    *,
    radius_mm: Range,
    force_n: Range,
    nodal_force_n: float,
    cone_deg: float,
    n_levels: int,
    n_paths: int,
    seed: int = 0,
) -> list[LoadPath]:
    """Return paths of loads on round patches, each of a size and force of its own.

    A path's patch lies about a loaded node chosen at random; its radius is uniform in
    the logarithm, its force uniform, its direction uniform on the spherical cap of
    half-angle `cone_deg` about the inward normal there.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    loaded : (n_loaded,) integer array
        Nodes that may be loaded.
    radius_mm : (float, float)
        Smallest and largest radius, along the chord, mm.
    force_n : (float, float)
        Smallest and largest force on a patch at load factor 1, N.
    nodal_force_n : float
        Largest force on one node, N. It limits the force on small patches.
    cone_deg : float
        Degrees, in [0, 180].
    n_levels, n_paths : int
        Equal load steps a path, and number of paths.
    seed : int
        Seed of the random draws.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    _check(radius_mm, force_n, nodal_force_n)
    nodes, factors = by_position(mesh, loaded), equal_levels(n_levels)
    points, normals = mesh.points[nodes], inward_normals(mesh, nodes)
    random = np.random.default_rng(seed)
    paths = []
    for _ in range(n_paths):
        centre = int(random.integers(len(nodes)))
        radius = np.exp(random.uniform(*np.log(radius_mm)))
        distance = np.linalg.norm(points - points[centre], axis=1)
        fraction = patch_load_fractions(distance / radius, normals, centre)
        force = min(random.uniform(*force_n), nodal_force_n / fraction.max())
        direction = within_cone(random, normals[centre], cone_deg)
        patch = np.flatnonzero(fraction)
        forces = force * fraction[patch, None] * direction
        paths.append(LoadPath(nodes[patch], forces, factors))
    return paths


def patch_load_fractions(
    distance: FloatArray, normals: FloatArray, nearest: int
) -> FloatArray:
    """Return the fraction of a patch load that each node carries.

    Even up to half the radius, falling to nothing at the radius as a cosine; they add
    up to 1. Where no node lies within the radius the nearest one takes all.

    Parameters
    ----------
    distance : (n,) array
        Of the nodes from the middle, over the radius.
    normals : (n, 3) array
        Their unit normals, all inward or all outward.
    nearest : int
        Which node is nearest to the middle.

    Returns
    -------
    (n,) array
    """
    falling = np.clip((distance - PLATEAU) / (1 - PLATEAU), 0.0, 1.0)
    fraction: FloatArray = 0.5 * (1.0 + np.cos(np.pi * falling))
    fraction[distance >= 1] = 0.0
    # The other side of a cleft is near, but no instrument touches both.
    fraction[normals @ normals[nearest] <= 0] = 0.0
    if not fraction.any():
        fraction[nearest] = 1.0
    fraction /= fraction.sum()
    return fraction


def _check(radius_mm: Range, force_n: Range, nodal_force_n: float) -> None:
    for name, (low, high) in (("radius_mm", radius_mm), ("force_n", force_n)):
        if not 0 < low <= high:
            raise InputError(
                f"{name} must be two numbers > 0, the smaller first (got {low}, {high})"
            )
    if not nodal_force_n > 0:
        raise InputError(f"nodal_force_n must be > 0 (got {nodal_force_n})")
