"""Shifts of a brain whose mesh, tissue and skull the registration does not know.

Simulated on another mesh than the one that is registered, finer, with other materials
(Poisson's ratio, stiffness of the tumour) and other points at the skull, under loads
outside the span of the load modes: weight in a random direction near the craniotomy's,
a retractor's narrow patch, and a pull on the tumour. Where the skull lets slide, it
resists a third as much as the registration thinks.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from physgnn.arrays import FloatArray
from physgnn.geometry import (
    Complement,
    Phantom,
    Sphere,
    TetMesh,
    boundary_faces,
    boundary_points,
    boundary_surface,
    mni152_phantom,
    select,
    tetrahedralize,
)
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
    farthest_points,
)
from physgnn.geometry.normals import vertex_normals
from physgnn.mechanics import NeoHookean
from physgnn.mechanics.body import Body
from physgnn.registration.skull import ALONG_MM, Support, fixed_support, sliding_support
from physgnn.registration.tangent_response import TangentResponse

EXPOSED_MM = 30.0
N_PAIRS, N_SURFACE, N_LANDMARKS = 50, 2000, 15
DEEP_MM = 50.0
N_BONE, BONE_NOISE_MM = 6, 0.5
RIM_MM = (40.0, 60.0)  # from the middle of the craniotomy to a point of the bone
THICK_MM = 5.0  # from the brain to it
NOISE_MM, SHIFT_MM = (0.5, 1.0), (5.0, 12.0)
TRUE_HELD_MM = 80.0
BUCKLED = 1.5  # times the linear solution
SURFACE_POINTS = 900
LEVELS, MAX_STEPS, CONVERGED_MM = 8, 15, 1e-3
TRUE_MATERIALS = {0: NeoHookean(2500.0, 0.45), 1: NeoHookean(9000.0, 0.47)}


def held(mesh: TetMesh, phantom: Phantom, radius_mm: float) -> TetMesh:
    """Return the mesh with the surface fixed outside of a sphere about the opening."""
    opening = Sphere(tuple(phantom.craniotomy_point), radius_mm)
    return mesh.with_point_sets(fixed=select(mesh, Complement(opening)))


@dataclass(frozen=True)
class Case:
    """A true shift and what was measured of it.

    Attributes
    ----------
    pairs : PointPairs
        Fifty places of the exposed surface.
    surface : SurfacePoints
        Two thousand others, after the shift alone.
    displacement : (n_points, 3) array
        The truth, mm.
    landmarks : Landmarks
        Fifteen points inside.
    whole : WholeSurface
        All of the surface after the shift.
    """

    pairs: PointPairs
    surface: SurfacePoints
    displacement: FloatArray
    landmarks: Landmarks
    whole: WholeSurface
    bone: BonePoints


def _support(body: Body, skull: str) -> Support:
    if skull == "fixed":
        return fixed_support(body)
    return sliding_support(body, along_mm=3.0 * ALONG_MM)


class Truth:
    """Simulates shifts of a body that the registration does not know.

    Parameters
    ----------
    n_points : int
        About how many the mesh has.
    skull : {"fixed", "sliding"}
        How the skull holds it.
    surface_points : int
        About how many the brain's surface has.
    """

    def __init__(
        self, n_points: int, skull: str, *, surface_points: int = SURFACE_POINTS
    ) -> None:
        self._skull = skull
        self.phantom = mni152_phantom(n_points=surface_points)
        surfaces = self.phantom.brain, self.phantom.tumours
        mesh = tetrahedralize(*surfaces, target_points=n_points)
        self.mesh = held(mesh, self.phantom, TRUE_HELD_MM)
        surface = boundary_points(self.mesh)
        self.free = np.setdiff1d(surface, self.mesh.point_set("fixed"))
        offset = self.mesh.points[self.free] - self.phantom.craniotomy_point
        self.exposed = self.free[np.linalg.norm(offset, axis=1) < EXPOSED_MM]
        offset = self.mesh.points - self.phantom.craniotomy_point
        depth = np.setdiff1d(np.arange(self.mesh.n_points), surface)
        self.deep = depth[np.linalg.norm(offset[depth], axis=1) < DEEP_MM]
        faces = boundary_faces(self.mesh)
        self.faces = faces[np.isin(faces, self.exposed).all(axis=1)]

    @cached_property
    def tangent(self) -> TangentResponse:
        """How the body responds to forces; made when it is first wanted."""
        body = Body(self.mesh, TRUE_MATERIALS)
        return TangentResponse(body, _support(body, self._skull))

    def case(self, seed: int) -> Case:
        """Simulate a shift and measure it; the same seed gives the same one."""
        rng = np.random.default_rng(seed)
        wanted = rng.uniform(*SHIFT_MM)
        forces = self._forces(rng)
        forces *= wanted / np.linalg.norm(self._linear(forces), axis=1).max()
        levels = self._equilibria(forces)
        reached = np.array([np.linalg.norm(u, axis=1).max() for u in levels])
        # a body that buckles under a retractor is no brain any more
        sound = reached < BUCKLED * wanted * np.arange(1, len(levels) + 1) / LEVELS
        u = levels[np.argmin(np.where(sound, abs(reached - wanted), 99))]
        noise = rng.uniform(*NOISE_MM)
        source, target = self._measure(rng, u, N_PAIRS, noise)
        _, surface = self._measure(rng, u, N_SURFACE, noise)
        inside = rng.choice(self.deep, N_LANDMARKS, replace=False)
        seen = self.mesh.points[inside]
        found = seen + u[inside] + rng.normal(scale=noise, size=seen.shape)
        landmarks = Landmarks(seen, found)
        pairs, exposed = PointPairs(source, target), SurfacePoints(surface)
        whole = self._whole(rng, u, noise)
        return Case(pairs, exposed, u, landmarks, whole, self._bone(seed))

    def _bone(self, seed: int) -> BonePoints:
        """Return points of the bone around the craniotomy, with noise."""
        rng = np.random.default_rng(seed)  # its own: the rest is as it was without
        outer = boundary_surface(self.mesh)
        far = np.linalg.norm(outer.points - self.phantom.craniotomy_point, axis=1)
        near = np.flatnonzero((far > RIM_MM[0]) & (far < RIM_MM[1]))
        rim = rng.permutation(np.intersect1d(near, outer.faces))
        points = outer.points[rim] + THICK_MM * vertex_normals(outer)[rim]
        some = points[farthest_points(points, count=N_BONE)]
        noise = rng.normal(scale=BONE_NOISE_MM, size=some.shape)
        return BonePoints(some, some + noise)

    def _whole(
        self, rng: np.random.Generator, u: FloatArray, noise: float
    ) -> WholeSurface:
        """Return the whole surface as it lies after the shift, with noise."""
        used, faces = np.unique(boundary_faces(self.mesh), return_inverse=True)
        moved = (self.mesh.points + u)[used]
        moved += rng.normal(scale=noise, size=moved.shape)
        return WholeSurface(moved, faces.reshape(-1, 3).astype(np.int64))

    def _measure(
        self, rng: np.random.Generator, u: FloatArray, count: int, noise: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return places on the exposed surface at rest and, with noise, moved."""
        corners = self.faces[rng.choice(len(self.faces), count)]
        weights = rng.dirichlet(np.ones(3), count)
        source, moved = (
            np.einsum("ni,nij->nj", weights, field[corners])
            for field in (self.mesh.points, self.mesh.points + u)
        )
        return source, moved + rng.normal(scale=noise, size=source.shape)

    def _linear(self, forces: FloatArray) -> FloatArray:
        rest = np.zeros_like(forces)
        found = self.tangent(rest, forces[None].astype(np.float32))
        assert found is not None
        moved: FloatArray = found[0][0].astype(np.float64)
        return moved

    def _equilibria(self, forces: FloatArray) -> list[FloatArray]:
        """Newton's method, level by level, as far as it goes."""
        u = np.zeros_like(forces)
        found: list[FloatArray] = []
        for level in range(1, LEVELS + 1):
            load = (level / LEVELS * forces)[None].astype(np.float32)
            for _ in range(MAX_STEPS):
                solved = self.tangent(u, load)
                if solved is None:
                    return found
                step = solved[0][0] + solved[1]
                u = u + step
                if np.linalg.norm(step, axis=1).max() < CONVERGED_MM:
                    found.append(u)
                    break
            else:
                return found
        return found

    def _forces(self, rng: np.random.Generator) -> FloatArray:
        """Weight, a retractor and a pull on the tumour, in random proportions."""
        mesh, phantom = self.mesh, self.phantom
        inward = mesh.points.mean(axis=0) - phantom.craniotomy_point
        inward /= np.linalg.norm(inward)
        share = np.zeros(mesh.n_points)
        np.add.at(share, mesh.cells, mesh.cell_volumes[:, None] / 4)
        weight = share[:, None] * _near(rng, inward, 40.0)
        centre = mesh.points[rng.choice(self.exposed)]
        width = rng.uniform(15.0, 25.0)
        square = ((mesh.points - centre) ** 2).sum(axis=1) / (2 * width**2)
        retractor = np.zeros_like(weight)
        retractor[self.free] = np.exp(-square)[self.free, None] * _near(
            rng, inward, 60.0
        )
        tumour = np.unique(mesh.cells[mesh.region == 1])
        pull = np.zeros_like(weight)
        pull[tumour] = share[tumour, None] * _near(rng, inward, 180.0)
        parts = [weight, retractor, pull]
        largest = [np.linalg.norm(self._linear(f), axis=1).max() for f in parts]
        amounts = rng.uniform([0.3, 0.0, 0.0], [1.0, 0.5, 0.2])
        total: FloatArray = np.zeros_like(weight)
        for amount, size, force in zip(amounts, largest, parts, strict=True):
            total += amount / size * force
        return total


def _near(
    rng: np.random.Generator, direction: FloatArray, degrees: float
) -> FloatArray:
    axis = np.cross(direction, rng.normal(size=3))
    turn = np.deg2rad(rng.uniform(0, degrees)) * axis / np.linalg.norm(axis)
    turned: FloatArray = Rotation.from_rotvec(turn).apply(direction)
    return turned
