"""Where a surface lies, not which of its points is which.

One component a point counts, along the normal, at the place nearest to it now
(point-to-plane matching, Chen & Medioni, Image and Vision Computing 10, 1992); what
slides within the surface remains free. A whole surface is matched both ways: its points
to the body's surface, and the body's to it, so that neither has a part that the other
lacks.
"""

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.measured import SurfacePoints, WholeSurface
from physgnn.geometry.normals import vertex_normals
from physgnn.geometry.surface import FaceArray, Surface
from physgnn.geometry.tetmesh import TetMesh
from physgnn.prediction.evidence import LARGEST_SHIFT_MM
from physgnn.registration.measurements.observation import Observation, stacked
from physgnn.registration.measurements.places import (
    at_points,
    check_distance,
    exposed_faces,
    nearest_places,
    shells_of,
)

N_SURFACE_POINTS = 300  # of a measured surface: one for every 10 mm² of a craniotomy


class MeasuredSurface:
    """Where the exposed surface lies; raises InputError if it is far from the body."""

    kind = "surface"

    def __init__(self, mesh: TetMesh, skull: IntArray, surface: SurfacePoints) -> None:
        exposed = exposed_faces(mesh, skull)
        if not len(exposed):
            raise InputError("the skull holds the whole surface: nothing is exposed")
        self._matched = _Matched(mesh, exposed, surface)
        self.points = self.measured = self._matched.points
        self.labels = _numbered(len(self.points))
        self.distance_mm = self._matched.distance_mm
        rest = self.observe(np.zeros_like(mesh.points))
        self.sunk_mm = -float(np.median(rest.missing))

    def observe(self, displacement: FloatArray) -> Observation:
        """Compare each measured point with the deformed surface nearest to it."""
        return self._matched.observe(displacement)


class MeasuredWholeSurface:
    """Where the whole surface lies; raises InputError if it is far from the body."""

    kind = "whole surface"

    def __init__(self, mesh: TetMesh, surface: WholeSurface) -> None:
        faces = _shown_faces(mesh, surface)
        self._matched = _Matched(mesh, faces, surface)
        self._rest = mesh.points
        own = np.unique(faces).astype(np.int64)
        order = np.random.default_rng(0).permutation(len(own))
        self._own = np.sort(own[order[:N_SURFACE_POINTS]])
        self._seen = Surface(surface.points, np.asarray(surface.faces))
        self._normals = vertex_normals(self._seen)
        self.points = np.concatenate([self._matched.points, mesh.points[self._own]])
        self.measured = self.points
        self.labels = _numbered(len(self.points))
        self.distance_mm, self.sunk_mm = self._matched.distance_mm, np.inf

    def observe(self, displacement: FloatArray) -> Observation:
        """Compare both surfaces, each point with the nearest place of the other."""
        there = self._matched.observe(displacement)
        moved = (self._rest + displacement)[self._own]
        places, nearest = nearest_places(self._seen.points, self._seen.faces, moved)
        normals = _unit(places @ self._normals)
        missing = np.einsum("ni,ni->n", normals, nearest - moved)
        at_own = at_points(self._own, len(self._rest))
        back = Observation(at_own, normals[:, None, :], missing[:, None])
        return stacked([there, back])


def _shown_faces(mesh: TetMesh, surface: WholeSurface) -> FaceArray:
    """Return the body's faces that a measured surface can show.

    One of a single shell, as a segmentation with its holes filled has it, shows nothing
    of the wall of a void inside, such as the cavity of a tumour that was taken out.
    """
    faces = boundary_faces(mesh)
    if shells_of(np.asarray(surface.faces), len(surface.points)).max(initial=0):
        return faces
    shell = shells_of(faces, mesh.n_points)
    widths = [
        float(np.ptp(mesh.points[faces[shell == k]].reshape(-1, 3), axis=0).max())
        for k in range(int(shell.max()) + 1)
    ]
    outer: FaceArray = faces[shell == int(np.argmax(widths))]
    return outer


class _Matched:
    """Measured points, each matched to the nearest place of some faces of a body."""

    def __init__(self, mesh: TetMesh, faces: FaceArray, surface: SurfacePoints) -> None:
        self._rest, self._faces = mesh.points, faces
        self.points = surface.thinned(N_SURFACE_POINTS).points
        _, nearest = nearest_places(self._rest, faces, self.points)
        check_distance(self.points, nearest, LARGEST_SHIFT_MM)
        away = np.linalg.norm(nearest - self.points, axis=1)
        self.distance_mm = float(np.median(away))

    def observe(self, displacement: FloatArray) -> Observation:
        moved = self._rest + displacement
        places, nearest = nearest_places(moved, self._faces, self.points)
        normals = _unit(places @ vertex_normals(Surface(moved, self._faces)))
        missing = np.einsum("ni,ni->n", normals, self.points - nearest)
        return Observation(places, normals[:, None, :], missing[:, None])


def _unit(vectors: FloatArray) -> FloatArray:
    sized: FloatArray = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return sized


def _numbered(count: int) -> tuple[str, ...]:
    return tuple(str(i + 1) for i in range(count))
