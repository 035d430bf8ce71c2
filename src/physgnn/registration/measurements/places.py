"""Where in a mesh something was measured: interpolation from its points."""

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.normals import area_vectors
from physgnn.geometry.surface import FaceArray
from physgnn.geometry.tetmesh import TetMesh

# Farther from the brain's surface than this, a point is in other coordinates.
SNAP_MM = 10.0
# A landmark may be so far outside of the mesh, whose surface is simpler than a brain's:
# it then takes the place nearest to it.
OUTSIDE_MM = 3.0


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
        MeasuredRows add up to 1.

    Raises
    ------
    InputError
        If a point is farther than 10 mm from the surface.
    """
    places, nearest = nearest_places(mesh.points, boundary_faces(mesh), points)
    check_distance(points, nearest, SNAP_MM)
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
    import pyvista as pv

    surface = pv.PolyData.from_regular_faces(points, faces.astype(int))
    face, found = surface.find_closest_cell(targets, return_closest_point=True)
    nearest = np.asarray(found, dtype=np.float64)
    corners = faces[face]
    weights = _barycentric(points[corners], nearest)
    rows = np.repeat(np.arange(len(targets)), 3)
    shape = (len(targets), len(points))
    return csr_array((weights.ravel(), (rows, corners.ravel())), shape), nearest


def cell_interpolation(
    mesh: TetMesh, points: FloatArray, labels: tuple[str, ...]
) -> csr_array:
    """Return the matrix P that takes values on mesh points to places inside.

    Each takes the values of the four corners of its cell, linearly interpolated.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    points : (n, 3) array
        World coordinates, mm.
    labels : tuple of str
        The name of each.

    Returns
    -------
    (n, n_points) sparse array
        MeasuredRows add up to 1.

    Raises
    ------
    InputError
        If points are more than 3 mm outside of the mesh; it names them.
    """
    import pyvista as pv

    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.cells}, mesh.points)
    found: Any = grid.find_closest_cell(points, return_closest_point=True)
    cell, nearest = found[0], np.asarray(found[1], dtype=np.float64)
    distance = np.linalg.norm(points - nearest, axis=1)
    far = np.flatnonzero(distance > OUTSIDE_MM)
    if len(far):
        names = ", ".join(f"'{labels[i]}' ({distance[i]:.1f} mm)" for i in far)
        raise InputError(
            f"landmarks must lie inside the brain (outside of it: {names}): check axes "
            "(RAS), units (mm) and --initial-transform"
        )
    corners = mesh.cells[cell]
    edges = mesh.points[corners[:, 1:]] - mesh.points[corners[:, :1]]
    away = nearest - mesh.points[corners[:, 0]]
    others = np.linalg.solve(edges.transpose(0, 2, 1), away[..., None])[..., 0]
    weights = np.column_stack([1.0 - others.sum(axis=1), others])
    rows = np.repeat(np.arange(len(points)), 4)
    shape = (len(points), mesh.n_points)
    return csr_array((weights.ravel(), (rows, corners.ravel())), shape)


def exposed_faces(mesh: TetMesh, skull: IntArray) -> FaceArray:
    """Return the faces that are seen through an opening of the skull.

    They are of the surface that the skull holds in part: nobody sees the walls of a
    void inside, such as the cavity of a tumour that was taken out.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    skull : integer array
        Points of the surface that are not exposed.
    """
    faces = boundary_faces(mesh)
    shell = shells_of(faces, mesh.n_points)
    held = np.isin(faces, skull)
    outer = np.isin(shell, shell[held.any(axis=1)])
    seen: FaceArray = faces[outer & ~held.all(axis=1)]
    return seen


def shells_of(faces: FaceArray, n_points: int) -> IntArray:
    """Return which shell each face is of, from 0: faces of one share points.

    Parameters
    ----------
    faces : (n_faces, 3) integer array
    n_points : int
        How many points there are.
    """
    ends = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = coo_array((np.ones(len(ends[0])), ends), (n_points, n_points))
    part = connected_components(graph, directed=False)[1]
    return np.unique(part[faces[:, 0]], return_inverse=True)[1].astype(np.int64)


def opening_direction(mesh: TetMesh, skull: IntArray) -> FloatArray:
    """Return the mean direction out of the surface that the skull doesn't hold.

    Parameters
    ----------
    mesh : TetMesh
        The rest state.
    skull : integer array
        Points of the surface that are not exposed.
    """
    exposed = exposed_faces(mesh, skull)
    total = area_vectors(mesh.points, exposed).sum(axis=0)
    unit: FloatArray = total / max(float(np.linalg.norm(total)), 1e-12)
    return unit


def at_points(chosen: IntArray, n_points: int) -> csr_array:
    """Return the matrix that picks values of some of a mesh's points."""
    each = np.arange(len(chosen))
    return csr_array((np.ones(len(chosen)), (each, chosen)), (len(chosen), n_points))


def check_distance(points: FloatArray, nearest: FloatArray, limit: float) -> None:
    """Raise InputError if a point is farther from its nearest place than a limit."""
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
