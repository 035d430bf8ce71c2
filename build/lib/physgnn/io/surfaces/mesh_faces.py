"""Surfaces from files of meshes: the triangles and quadrilaterals among their cells."""

from pathlib import Path

import numpy as np

from physgnn.arrays import IntArray
from physgnn.errors import InputError
from physgnn.geometry.surface import Surface, merge_points
from physgnn.io.meshes.reader import read_mesh_file
from physgnn.io.vtk.data import VtkData
from physgnn.io.vtk.vtp import triangulated

TETRAHEDRA = (10, 24)
QUADRATIC = {22: 3, 23: 4}
"""VTK's numbers of faces with points on their edges, and how many corners they have."""
FACES = (5, 6, 7, 9)  # triangle, strip of triangles, polygon, quadrilateral


def read_mesh_faces(path: Path) -> Surface:
    """Read the faces of a mesh; polygons become triangles, equal points one.

    The points are in RAS+ already.
    """
    data = read_mesh_file(path).data
    if np.isin(data.cell_types, TETRAHEDRA).any():
        raise InputError(
            "a surface must be triangles (this holds tetrahedra): give it as a mesh, "
            "'physgnn mesh FILE -o case.vtu'"
        )
    faces = _corners_alone(data)
    if data.n_points == 0 or len(faces.connectivity) == 0:
        raise InputError("the surface is empty: export it again")
    return merge_points(faces.points, triangulated(faces).astype(np.int32))


def _corners_alone(data: VtkData) -> VtkData:
    """Return the faces alone, each by its corners."""
    kinds, lengths = data.cell_types.copy(), np.diff(data.offsets)
    for kind, corners in QUADRATIC.items():
        lengths[kinds == kind] = np.minimum(lengths[kinds == kind], corners)
        kinds[kinds == kind] = FACES[0] if corners == 3 else FACES[3]
    chosen = np.flatnonzero(np.isin(kinds, FACES))
    parts: list[IntArray] = [
        data.connectivity[data.offsets[i] : data.offsets[i] + lengths[i]]
        for i in chosen
    ]
    return VtkData(
        points=data.points,
        connectivity=np.concatenate([np.empty(0, np.int64), *parts]),
        offsets=np.concatenate([[0], np.cumsum(lengths[chosen])]),
        cell_types=np.where(kinds[chosen] == FACES[1], FACES[1], FACES[2]),
    )
