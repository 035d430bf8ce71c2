"""Shifts of a block in a box, open at the top, and what is measured of them."""

import numpy as np

from meshes import block_mesh
from physgnn.arrays import FloatArray
from physgnn.geometry import boundary_faces
from physgnn.geometry.measured import Landmarks, PointPairs, SurfacePoints
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics import LoadPath, NeoHookean, RestState, Solver
from physgnn.mechanics.body import Body
from physgnn.registration.registrar import Registrar
from physgnn.registration.result import Registration

SIDE = 100.0
MATERIALS = {0: NeoHookean(3000.0, 0.45), 1: NeoHookean(6000.0, 0.45)}
NOISE = 0.7


def open_box(cells: int = 6) -> TetMesh:
    mesh = block_mesh(cells, side=SIDE, jitter=0.1)
    x, y, z = mesh.points.T
    wall = (z == 0) | np.isin(x, [0, SIDE]) | np.isin(y, [0, SIDE])
    return mesh.with_point_sets(
        fixed=np.flatnonzero(wall), loaded=np.flatnonzero(~wall & (z == SIDE))
    )


def true_shift(mesh: TetMesh, seed: int, size_mm: float) -> FloatArray:
    """A sag to one side with a push on top, of a body stiffened otherwise."""
    rng = np.random.default_rng(seed)
    materials = {0: NeoHookean(3000.0, 0.4), 1: NeoHookean(4000.0, 0.47)}
    forces = np.tile([*rng.uniform(-0.5, 0.5, 2), -1.0], (mesh.n_points, 1))
    top = mesh.point_set("loaded")
    offset = mesh.points[top] - [*rng.uniform(30, 70, 2), SIDE]
    forces[top] -= [0, 0, 5] * np.exp(-(offset**2).sum(1, keepdims=True) / 2 / 25**2)
    rest = RestState(Body(mesh, materials))
    forces *= size_mm / np.linalg.norm(rest.solve(forces), axis=1).max()
    loaded = np.setdiff1d(np.arange(mesh.n_points), mesh.point_set("fixed"))
    path = LoadPath(loaded, forces[loaded], np.ones(1))
    return Solver(Body(mesh, materials)).solve(path).displacement[0]


def measured(mesh: TetMesh, u: FloatArray, seed: int) -> PointPairs:
    top = mesh.point_set("loaded")
    source = mesh.points[top]
    noise = np.random.default_rng(seed).normal(scale=NOISE, size=source.shape)
    return PointPairs(source, source + u[top] + noise)


def seen_surface(mesh: TetMesh, u: FloatArray, seed: int) -> SurfacePoints:
    """Noisy places all over the top where it lies now, in no order."""
    rng = np.random.default_rng(seed)
    faces = boundary_faces(mesh)
    faces = faces[np.isin(faces, mesh.point_set("loaded")).all(axis=1)]
    corners = faces[rng.choice(len(faces), 600)]
    weights = rng.dirichlet(np.ones(3), len(corners))
    points = np.einsum("ni,nij->nj", weights, (mesh.points + u)[corners])
    return SurfacePoints(points + rng.normal(scale=NOISE, size=points.shape))


def errors(found: Registration, u: FloatArray) -> FloatArray:
    return np.linalg.norm(found.prediction.displacement - u, axis=1)


def seen_inside(mesh: TetMesh, u: FloatArray, seed: int, count: int = 12) -> Landmarks:
    """Noisy places of points inside, near the top."""
    rng = np.random.default_rng(seed)
    x, y, z = mesh.points.T
    deep = np.flatnonzero((z > 40) & (z < SIDE) & (x > 0) & (x < SIDE) & (y > 0))
    deep = deep[mesh.points[deep, 1] < SIDE]
    chosen = rng.choice(deep, count, replace=False)
    source = mesh.points[chosen]
    noise = rng.normal(scale=NOISE, size=source.shape)
    return Landmarks(source, source + u[chosen] + noise)


def leaning(mesh: TetMesh, size_mm: float) -> FloatArray:
    """Linear elasticity under weight and a patch of traction: no tracker moves so."""
    modes = Registrar(Body(mesh, MATERIALS)).modes
    u = (modes.response[10] - modes.response[2]).astype(np.float64)
    return u * size_mm / np.linalg.norm(u, axis=1).max()
