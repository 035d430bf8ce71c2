"""From the displacement of a mesh to that of measured points on its surface."""

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.sparse import csr_array

from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.tetmesh import TetMesh

FloatArray = NDArray[np.float64]

# Farther from the brain's surface than this, a point is in other coordinates.
SNAP_MM = 10.0


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
    faces = boundary_faces(mesh)
    surface = pv.PolyData.from_regular_faces(mesh.points, faces.astype(int))
    face, nearest = surface.find_closest_cell(points, return_closest_point=True)
    distance = np.linalg.norm(points - nearest, axis=1)
    far = int(distance.argmax())
    if distance[far] > SNAP_MM:
        raise InputError(
            f"measured point {far + 1}, {points[far].round(1).tolist()}, is "
            f"{distance[far]:.1f} mm from the brain's surface (at most "
            f"{SNAP_MM:g} mm): check axes (RAS) and units (mm)"
        )
    corners = faces[face]
    weights = _barycentric(mesh.points[corners], np.asarray(nearest))
    rows = np.repeat(np.arange(len(points)), 3)
    return csr_array(
        (weights.ravel(), (rows, corners.ravel())), (len(points), mesh.n_points)
    )


def _barycentric(corners: FloatArray, points: FloatArray) -> FloatArray:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    edges = np.stack([a, b], axis=2)
    offset = (points - corners[:, 0])[..., None]
    two = np.linalg.pinv(edges) @ offset
    weights: FloatArray = np.concatenate([1 - two.sum(axis=1), two[..., 0]], axis=1)
    return weights
