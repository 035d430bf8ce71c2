"""What a measurement says of a displacement, linearised about any state.

Point pairs say where material points went: three components each. A measured surface
says how far the body's own surface lies from it: one component a point, along the
normal, at the place nearest to it now (point-to-plane matching, Chen & Medioni, Image
and Vision Computing 10, 1992); what slides within the surface remains free.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import pyvista as pv
from scipy.sparse import csr_array

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.measured import PointPairs, SurfacePoints
from physgnn.geometry.normals import vertex_normals
from physgnn.geometry.surface import FaceArray, Surface
from physgnn.geometry.tetmesh import TetMesh
from physgnn.prediction.evidence import LARGEST_SHIFT_MM

# Farther from the brain's surface than this, a point is in other coordinates; a
# measured surface is as far away as the shift is large.
SNAP_MM = 10.0
N_SURFACE_POINTS = 300  # of a measured surface: one for every 10 mm² of a craniotomy


@dataclass(frozen=True, eq=False)
class Observation:
    """Components of the displacement of some places, and what they lack.

    Attributes
    ----------
    places : (n, n_points) sparse array
        From values on mesh points to values at the places.
    axes : (n, k, 3) array
        The k directions measured at each place.
    missing : (n, k) array
        Measured minus present component, mm.
    """

    places: csr_array
    axes: FloatArray
    missing: FloatArray

    def of(self, field: FloatArray) -> FloatArray:
        """Return the components of a displacement (n_points, 3), shape (n, k)."""
        seen: FloatArray = np.einsum("nki,ni->nk", self.axes, self.places @ field)
        return seen

    def after(self, step: FloatArray) -> "Observation":
        """Return what is left after a further displacement, places and axes kept."""
        return replace(self, missing=self.missing - self.of(step))


class Measurement(Protocol):
    """Anything that can be compared with a displacement.

    Attributes
    ----------
    kind : str
        "pairs" or "surface".
    points : (n, 3) array
        Where it was measured, mm.
    distance_mm : float
        Median distance of the points from the body's surface at rest.
    """

    kind: str
    points: FloatArray
    distance_mm: float

    def observe(self, displacement: FloatArray) -> Observation:
        """Return what is measured about a displacement (n_points, 3), mm."""
        ...


class MeasuredPairs:
    """Where points of the surface went; raises InputError if one is far from it."""

    kind = "pairs"

    def __init__(self, mesh: TetMesh, pairs: PointPairs) -> None:
        self.moved, self.points = pairs.displacement, pairs.source
        self._places = surface_interpolation(mesh, pairs.source)
        nearest = self._places @ mesh.points
        self.distance_mm = _median_distance(nearest, pairs.source)
        self._axes = np.tile(np.eye(3), (len(self.moved), 1, 1))

    def observe(self, displacement: FloatArray) -> Observation:
        """Compare the displacement of each point with the measured one."""
        missing = self.moved - self._places @ displacement
        return Observation(self._places, self._axes, missing)


class MeasuredSurface:
    """Where the exposed surface lies; raises InputError if it is far from the body."""

    kind = "surface"

    def __init__(self, mesh: TetMesh, skull: IntArray, surface: SurfacePoints) -> None:
        faces = boundary_faces(mesh)
        self._faces = faces[~np.isin(faces, skull).all(axis=1)]
        self._rest = mesh.points
        self.points = surface.thinned(N_SURFACE_POINTS).points
        if not len(self._faces):
            raise InputError("the skull holds the whole surface: nothing is exposed")
        _, nearest = nearest_places(self._rest, self._faces, self.points)
        _check_distance(self.points, nearest, LARGEST_SHIFT_MM)
        self.distance_mm = _median_distance(nearest, self.points)

    def observe(self, displacement: FloatArray) -> Observation:
        """Compare each measured point with the deformed surface nearest to it."""
        moved = self._rest + displacement
        places, nearest = nearest_places(moved, self._faces, self.points)
        normals = places @ vertex_normals(Surface(moved, self._faces))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        missing = np.einsum("ni,ni->n", normals, self.points - nearest)
        return Observation(places, normals[:, None, :], missing[:, None])


def surface_interpolation(mesh: TetMesh, points: FloatArray) -> csr_array:
    """Return the matrix P that takes values on mesh points to measured points.

    Each measured point takes the place on the outer surface nearest to it, and the
    values of that face's three points, linearly interpolated.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    points : (n, 3) array
        World coordinates, mm.

    Returns
    -------
    (n, n_points) sparse array
        Rows add up to 1.

    Raises
    ------
    InputError
        If a point is farther than 10 mm from the surface.
    """
    places, nearest = nearest_places(mesh.points, boundary_faces(mesh), points)
    _check_distance(points, nearest, SNAP_MM)
    return places


def nearest_places(
    points: FloatArray, faces: FaceArray, targets: FloatArray
) -> tuple[csr_array, FloatArray]:
    """Return each target's nearest place on a surface: interpolation and coordinates.

    Parameters
    ----------
    points, faces
        Of the surface; points of no face may be among them.
    targets : (n, 3) array
        mm.
    """
    surface = pv.PolyData.from_regular_faces(points, faces.astype(int))
    face, found = surface.find_closest_cell(targets, return_closest_point=True)
    nearest = np.asarray(found, dtype=np.float64)
    corners = faces[face]
    weights = _barycentric(points[corners], nearest)
    rows = np.repeat(np.arange(len(targets)), 3)
    shape = (len(targets), len(points))
    return csr_array((weights.ravel(), (rows, corners.ravel())), shape), nearest


def _median_distance(a: FloatArray, b: FloatArray) -> float:
    return float(np.median(np.linalg.norm(a - b, axis=1)))


def _check_distance(points: FloatArray, nearest: FloatArray, limit: float) -> None:
    distance = np.linalg.norm(points - nearest, axis=1)
    far = int(distance.argmax())
    if distance[far] > limit:
        raise InputError(
            f"measured point {far + 1}, {points[far].round(1).tolist()}, is "
            f"{distance[far]:.1f} mm from the brain's surface (at most "
            f"{limit:g} mm): check axes (RAS) and units (mm)"
        )


def _barycentric(corners: FloatArray, points: FloatArray) -> FloatArray:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    edges = np.stack([a, b], axis=2)
    offset = (points - corners[:, 0])[..., None]
    two = np.linalg.pinv(edges) @ offset
    weights: FloatArray = np.concatenate([1 - two.sum(axis=1), two[..., 0]], axis=1)
    return weights
