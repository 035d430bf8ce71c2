"""What is measured of a simulated shift, and where.

Near the craniotomy the surface is exposed: there 50 points are seen before and after,
and 2000 others after alone. 15 landmarks lie inside. All have the same noise. Points of
the bone around the craniotomy have their own, and the whole surface is there for
registrations of an intraoperative scan.
"""

from dataclasses import dataclass, field

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry import TetMesh, boundary_faces, boundary_points, boundary_surface
from physgnn.geometry.measured import (
    BonePoints,
    Landmarks,
    PointPairs,
    SurfacePoints,
    WholeSurface,
    farthest_points,
)
from physgnn.geometry.normals import vertex_normals
from physgnn.registration.causes import CAVITY

EXPOSED_MM = 30.0
N_PAIRS, N_SURFACE, N_LANDMARKS = 50, 2000, 15
DEEP_MM = 50.0
N_BONE, BONE_NOISE_MM = 6, 0.5
RIM_MM = (40.0, 60.0)  # from the middle of the craniotomy to a point of the bone
THICK_MM = 5.0  # from the brain to it
NOISE_MM = (0.5, 1.0)


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
    bone : BonePoints
        Six points of the bone, which do not move.
    """

    pairs: PointPairs
    surface: SurfacePoints
    displacement: FloatArray
    landmarks: Landmarks
    whole: WholeSurface
    bone: BonePoints


@dataclass(frozen=True, eq=False)
class SeenPlaces:
    """Where a body is measured.

    Parameters
    ----------
    mesh : TetMesh
        The rest state, with the point set ``fixed``; the walls of a cavity are not
        seen.
    craniotomy_point : (3,) array
        The middle of the craniotomy, mm.

    Attributes
    ----------
    free, exposed, deep : integer array
        Points of the surface that are not held, those of them that are seen, and points
        inside that may be landmarks.
    """

    mesh: TetMesh
    craniotomy_point: FloatArray
    free: IntArray = field(init=False)
    exposed: IntArray = field(init=False)
    deep: IntArray = field(init=False)

    def __post_init__(self) -> None:
        mesh, surface = self.mesh, boundary_points(self.mesh)
        away = np.linalg.norm(mesh.points - self.craniotomy_point, axis=1)
        free = np.setdiff1d(surface, mesh.point_set("fixed"))
        seen = np.setdiff1d(free, mesh.point_sets.get(CAVITY, np.empty(0, np.int64)))
        inside = np.setdiff1d(np.arange(mesh.n_points), surface)
        object.__setattr__(self, "free", free)
        object.__setattr__(self, "exposed", seen[away[seen] < EXPOSED_MM])
        object.__setattr__(self, "deep", inside[away[inside] < DEEP_MM])

    def measured(self, u: FloatArray, rng: np.random.Generator, seed: int) -> Case:
        """Measure a shift, with noise.

        Parameters
        ----------
        u : (n_points, 3) array
            The shift, mm.
        rng : numpy.random.Generator
            Of places and noise.
        seed : int
            Of the points of the bone.
        """
        noise = rng.uniform(*NOISE_MM)
        source, target = self._seen(rng, u, N_PAIRS, noise)
        _, surface = self._seen(rng, u, N_SURFACE, noise)
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
        far = np.linalg.norm(outer.points - self.craniotomy_point, axis=1)
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

    def _seen(
        self, rng: np.random.Generator, u: FloatArray, count: int, noise: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return places on the exposed surface at rest and, with noise, moved."""
        faces = boundary_faces(self.mesh)
        faces = faces[np.isin(faces, self.exposed).all(axis=1)]
        corners = faces[rng.choice(len(faces), count)]
        weights = rng.dirichlet(np.ones(3), count)
        source, moved = (
            np.einsum("ni,nij->nj", weights, field[corners])
            for field in (self.mesh.points, self.mesh.points + u)
        )
        return source, moved + rng.normal(scale=noise, size=source.shape)
