"""A surface of triangles made fit to be meshed: faults cut out, the holes closed.

Clustering a fine surface's points into even triangles may leave edges of three faces in
thin places, or sheets that cross. Such faces go, with their neighbours where that is
not enough, and VTK closes the holes.
"""

from importlib.util import find_spec

import numpy as np
import pyvista as pv

from physgnn.arrays import BoolArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.surface import FaceArray, Surface, directed_edges
from physgnn.geometry.surfaces.checks import check_surface
from physgnn.geometry.surfaces.intersections import crossing_faces
from physgnn.geometry.surfaces.manifold import edge_counts, pinched_points

# Each round cuts one more ring of neighbours around what is still at fault.
ROUNDS = 4
# A hole as large as the surface is none that cutting has made.
ANY_SIZE = 1e6


def meshfix_available() -> bool:
    """Whether the pymeshfix package is installed."""
    return find_spec("pymeshfix") is not None


def repaired(surface: Surface, name: str) -> Surface:
    """Return a closed, outward surface of one piece that does not cross itself.

    A surface without faults keeps its points and faces. MeshFix (Attene, The Visual
    Computer 26, 2010) tries what is left over, where its package is installed.

    Parameters
    ----------
    surface : Surface
        Triangles, most of them sound; mm.
    name : str
        What messages call it.

    Raises
    ------
    InputError
        If faults are left.
    """
    found, fault = surface, None
    for rings in range(ROUNDS):
        try:
            return check_surface(found, name)[0]
        except InputError as error:
            fault = fault or error
        rest = _without_faults(found, rings)
        if rest is None:
            break
        found = _filled(rest)
    if meshfix_available():
        return check_surface(_by_meshfix(surface), name)[0]
    raise InputError(
        f"{fault}; MeshFix may do it (pip install 'physgnn[meshfix]')"
    ) from fault


def _without_faults(surface: Surface, rings: int) -> Surface | None:
    """Return the largest piece of what is left when faces at fault are taken out."""
    faces = _different(surface.faces)
    bad = _at_crowded_edges(faces)
    if not bad.any():
        bad[np.isin(faces, _pinched(faces)).any(axis=1)] = True
        bad[crossing_faces(Surface(surface.points, faces)).ravel()] = True
    for _ in range(rings):
        bad = np.asarray(np.isin(faces, faces[bad]).any(axis=1))
    if bad.all():
        return None
    rest = pv.PolyData.from_regular_faces(surface.points, faces[~bad].astype(int))
    return _surface(rest.connectivity("largest"))


def _different(faces: FaceArray) -> FaceArray:
    """Return the faces of three points, each once."""
    rows = np.sort(faces, axis=1)
    _, first = np.unique(rows, axis=0, return_index=True)
    kept = np.zeros(len(faces), dtype=bool)
    kept[first] = True
    return faces[kept & (np.diff(rows, axis=1) > 0).all(axis=1)]


def _at_crowded_edges(faces: FaceArray) -> BoolArray:
    """Return which faces lie at an edge of more than two."""
    edges = np.sort(directed_edges(faces), axis=1)
    _, index, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    crowded = (count > 2)[index.reshape(-1)]
    return np.asarray(crowded.reshape(3, -1).any(axis=0))


def _pinched(faces: FaceArray) -> IntArray:
    """Return the points where sheets touch, of a surface without holes."""
    _, count = edge_counts(faces)
    closed = bool((count == 2).all())
    return pinched_points(faces) if closed else np.zeros(0, dtype=np.int64)


def _filled(surface: Surface) -> Surface:
    poly = pv.PolyData.from_regular_faces(surface.points, surface.faces.astype(int))
    return _surface(poly.fill_holes(ANY_SIZE))


def _surface(poly: pv.PolyData) -> Surface:
    points = np.asarray(poly.points, dtype=np.float64)
    return Surface(points, poly.triangulate().regular_faces.astype(np.int32))


def _by_meshfix(surface: Surface) -> Surface:
    import pymeshfix

    fixer = pymeshfix.MeshFix(surface.points, surface.faces)
    fixer.repair()
    return Surface(fixer.points, fixer.faces)
