"""Load paths drawn at random: the two published sets, and cones for anything else."""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_surface
from physgnn.geometry.normals import area_vectors, vertex_normals
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.loads.paths import LoadPath

MATLAB_SEED = 5489  # the Mersenne Twister seed behind MATLAB's "seed 0"
PUBLISHED_DIRECTIONS = 15
FURTHER_SEED = 1_000_003  # of paths drawn beyond those of a dataset; added to its seed
# Rows of the published draw whose forces inverted elements, and the rows of a second
# draw that took their place.
REPLACED = (42, 44, 46, 48, 49, 53, 54, 55, 66, 90)
REPLACED_BY = (44, 45, 46, 47, 48, 51, 52, 55, 67, 101)


def equal_levels(n_levels: int) -> FloatArray:
    """Return the load factors 1/n, 2/n, …, 1."""
    if n_levels < 1:
        raise InputError(f"levels must be 1 or more (got {n_levels})")
    return np.arange(1, n_levels + 1) / n_levels


def inward_normals(mesh: TetMesh, nodes: IntArray) -> FloatArray:
    """Return the unit normals of the outer surface that point into the tissue."""
    return -vertex_normals(boundary_surface(mesh))[nodes]


def single_node_paths(
    mesh: TetMesh, loaded: IntArray, *, force_n: float, n_levels: int
) -> list[LoadPath]:
    """Return the published paths of dataset 1: one node at a time, 15 directions each.

    Direction 0 is the inward normal. The others are uniform draws, kept if they are
    oblique enough, with the sign of the inward normal in every component.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    loaded : (n_loaded,) integer array
        Nodes, at most 11: the published draw gives no more directions.
    force_n : float
        Force at load factor 1, N.
    n_levels : int
        Equal steps up to it.

    Returns
    -------
    list of LoadPath
        All directions of the first node, then of the second; nodes by (x, y, z).
    """
    nodes = by_position(mesh, loaded)
    others = PUBLISHED_DIRECTIONS - 1
    random = np.random.RandomState(MATLAB_SEED)
    directions = _oblique(uniform_directions(random, 924))[: 11 * others]
    directions[list(REPLACED)] = uniform_directions(random, 154)[list(REPLACED_BY)]
    if len(nodes) * others > len(directions):
        raise InputError(f"this rule loads at most 11 nodes (got {len(nodes)})")
    normals = inward_normals(mesh, nodes)
    directions = directions[: len(nodes) * others].reshape(-1, others, 3)
    directions = np.copysign(directions, normals[:, None])
    directions = np.concatenate([normals[:, None], directions], axis=1)
    factors = equal_levels(n_levels)
    return [
        LoadPath(np.array([node]), force_n * direction[None], factors)
        for node, of_node in zip(nodes, directions, strict=True)
        for direction in of_node
    ]


def further_single_node_paths(
    mesh: TetMesh, loaded: IntArray, n_paths: int, *, force_n: float, n_levels: int
) -> list[LoadPath]:
    """Return further paths like those of dataset 1, none of which is among them.

    The nodes take turns; directions are drawn as in `single_node_paths`.

    Parameters
    ----------
    mesh, loaded, force_n, n_levels
        As of `single_node_paths`.
    n_paths : int
        How many.
    """
    nodes = by_position(mesh, loaded)
    normals, factors = inward_normals(mesh, nodes), equal_levels(n_levels)
    random = np.random.RandomState(FURTHER_SEED)
    drawn = np.empty((0, 3))
    while len(drawn) < n_paths:
        more = _oblique(uniform_directions(random, 8 * n_paths))
        drawn = np.concatenate([drawn, more])
    turns = np.arange(n_paths) % len(nodes)
    directions = np.copysign(drawn[:n_paths], normals[turns])
    return [
        LoadPath(nodes[turn, None], force_n * direction[None], factors)
        for turn, direction in zip(turns, directions, strict=True)
    ]


def _oblique(drawn: FloatArray) -> FloatArray:
    """Return the directions that the published set takes, of those drawn."""
    x, y, z = np.abs(drawn).T
    kept: FloatArray = drawn[(x < 0.6) & (y < 0.6) & (z > 0.2) & (z < 0.9)]
    return kept


def all_node_paths(
    mesh: TetMesh,
    loaded: IntArray,
    *,
    total_force_n: float,
    n_levels: int,
    n_paths: int,
) -> list[LoadPath]:
    """Return the published paths of dataset 2: all nodes at once, each its own way.

    Path 0 pushes every node along its inward normal. In the others every node has a
    uniform draw of its own, with the sign of the inward normal in z.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    loaded : (n_loaded,) integer array
        Nodes.
    total_force_n : float
        Sum of the magnitudes of all nodes' forces at load factor 1, N.
    n_levels : int
        Equal steps up to it.
    n_paths : int
        How many; the published set has 165.
    """
    nodes = by_position(mesh, loaded)
    normals = inward_normals(mesh, nodes)
    drawn = _each_its_own(normals, n_paths - 1, MATLAB_SEED)
    forces = total_force_n / len(nodes) * np.concatenate([normals[None], drawn])
    return [LoadPath(nodes, force, equal_levels(n_levels)) for force in forces]


def further_all_node_paths(
    mesh: TetMesh,
    loaded: IntArray,
    n_paths: int,
    *,
    total_force_n: float,
    n_levels: int,
) -> list[LoadPath]:
    """Return further paths like those of dataset 2, none of which is among them.

    Parameters
    ----------
    mesh, loaded, n_paths, total_force_n, n_levels
        As of `all_node_paths`; every path has a draw.
    """
    nodes = by_position(mesh, loaded)
    drawn = _each_its_own(inward_normals(mesh, nodes), n_paths, FURTHER_SEED)
    forces = total_force_n / len(nodes) * drawn
    return [LoadPath(nodes, force, equal_levels(n_levels)) for force in forces]


def _each_its_own(normals: FloatArray, n_paths: int, seed: int) -> FloatArray:
    """Return a direction for every node on every path, (n_paths, n_nodes, 3)."""
    random = np.random.RandomState(seed)
    drawn = uniform_directions(random, len(normals) * n_paths)
    drawn = drawn.reshape(len(normals), n_paths, 3)
    drawn[:, :, 2] = np.copysign(drawn[:, :, 2], normals[:, None, 2])
    directions: FloatArray = drawn.transpose(1, 0, 2)
    return directions


def cone_paths(
    mesh: TetMesh,
    loaded: IntArray,
    *,
    total_force_n: float,
    n_levels: int,
    n_paths: int,
    cone_deg: float,
    nodes_per_path: int | None = None,
    seed: int = 0,
) -> list[LoadPath]:
    """Return paths that push a patch of nodes in one direction within a cone.

    A path's patch is the `nodes_per_path` loaded nodes nearest to a loaded node chosen
    at random; its direction is uniform on the spherical cap of half-angle `cone_deg`
    about the patch's mean inward normal; every node carries the same force.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    loaded : (n_loaded,) integer array
        Nodes that may be loaded.
    total_force_n : float
        Force on the patch at load factor 1, N.
    n_levels, n_paths : int
        Equal load steps a path, and number of paths.
    cone_deg : float
        Half-angle of the cone, degrees, in [0, 180].
    nodes_per_path : int, optional
        Nodes of a patch; by default all of `loaded`.
    seed : int
        Seed of the random draws.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    nodes = by_position(mesh, loaded)
    size = len(nodes) if nodes_per_path is None else nodes_per_path
    if not 1 <= size <= len(nodes):
        raise InputError(f"nodes_per_path must be in 1…{len(nodes)} (got {size})")
    random = np.random.default_rng(seed)
    normals = inward_normals(mesh, nodes)
    factors = equal_levels(n_levels)
    paths = []
    for _ in range(n_paths):
        centre = mesh.points[nodes[random.integers(len(nodes))]]
        distance = np.linalg.norm(mesh.points[nodes] - centre, axis=1)
        patch = np.argsort(distance, kind="stable")[:size]
        direction = within_cone(random, normals[patch].mean(axis=0), cone_deg)
        forces = np.tile(total_force_n / size * direction, (size, 1))
        paths.append(LoadPath(nodes[patch], forces, factors))
    return paths


def traction_paths(
    mesh: TetMesh,
    loaded: IntArray,
    *,
    traction_pa: float,
    n_levels: int,
    n_paths: int,
    seed: int = 0,
) -> list[LoadPath]:
    """Return paths that push all nodes, each its own way, for bodies of any size.

    As `all_node_paths`, but wherever on the body the nodes lie: every node has a
    uniform draw from the hemisphere about its inward normal, and all the same force.

    Parameters
    ----------
    mesh : TetMesh
        The mesh.
    loaded : (n_loaded,) integer array
        Nodes that make up whole faces of the surface.
    traction_pa : float
        Sum of the forces' magnitudes over the faces' area at load factor 1, Pa.
    n_levels, n_paths : int
        Equal load steps a path, and number of paths.
    seed : int
        Seed of the random draws.
    """
    nodes = by_position(mesh, loaded)
    surface = boundary_surface(mesh)
    faces = surface.faces[np.isin(surface.faces, nodes).all(axis=1)]
    area = np.linalg.norm(area_vectors(surface.points, faces), axis=1).sum()
    drawn = np.random.default_rng(seed).normal(size=(n_paths, len(nodes), 3))
    drawn /= np.linalg.norm(drawn, axis=2, keepdims=True)
    inward = np.einsum("pni,ni->pn", drawn, inward_normals(mesh, nodes))
    drawn *= np.where(inward < 0, -1.0, 1.0)[..., None]
    forces = 1e-6 * traction_pa * area / len(nodes) * drawn
    factors = equal_levels(n_levels)
    return [LoadPath(nodes, force, factors) for force in forces]


def by_position(mesh: TetMesh, nodes: IntArray) -> IntArray:
    """Return the nodes ordered by x, then y, then z."""
    x, y, z = mesh.points[nodes].T
    return np.asarray(nodes)[np.lexsort((z, y, x))]


def uniform_directions(random: np.random.RandomState, n: int) -> FloatArray:
    """Return n unit vectors, uniform on the sphere (Archimedes: z is uniform)."""
    u, v = random.random_sample((2, n))
    z = 1 - 2 * u
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(2 * np.pi * v), r * np.sin(2 * np.pi * v), z], axis=1)


def within_cone(
    random: np.random.Generator, axis: FloatArray, half_angle_deg: float
) -> FloatArray:
    """Return a unit vector, uniform on the cap of that half-angle about an axis."""
    if not 0 <= half_angle_deg <= 180:
        raise InputError(f"cone_deg must be in 0…180 (got {half_angle_deg})")
    z = random.uniform(np.cos(np.deg2rad(half_angle_deg)), 1.0)
    turn = random.uniform(0.0, 2 * np.pi)
    axis = axis / np.linalg.norm(axis)
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    around = np.cos(turn) * side + np.sin(turn) * np.cross(axis, side)
    direction: FloatArray = z * axis + np.sqrt(1 - z**2) * around
    return direction
