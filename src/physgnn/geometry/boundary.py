"""The outer boundary of a tetrahedral mesh."""

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import IntArray
from physgnn.geometry.cell_checks import CELL_FACES
from physgnn.geometry.surface import FaceArray, Surface
from physgnn.geometry.tetmesh import TetMesh


def boundary_faces(mesh: TetMesh) -> FaceArray:
    """Return the faces of one cell only, outward, shape (n_faces, 3).

    A tumour's surface lies between two cells and is not among them.

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.

    Returns
    -------
    (n_faces, 3) array of int32
        Point indices, counter-clockwise seen from outside.
    """
    return _faces_of_one(mesh.cells)


def region_faces(mesh: TetMesh, label: int) -> FaceArray:
    """Return the faces round a region's cells, outward, shape (n_faces, 3)."""
    return _faces_of_one(mesh.cells[mesh.region == label])


def _faces_of_one(cells: NDArray[np.int32]) -> FaceArray:
    faces = cells[:, CELL_FACES].reshape(-1, 3)
    one, two, three = faces.T.astype(np.int64)
    least = np.minimum(np.minimum(one, two), three)
    most = np.maximum(np.maximum(one, two), three)
    # two numbers that tell a face's corners, whatever their order
    others = one + two + three - least
    pair = least * (int(cells.max(initial=0)) + 1) + most
    order = np.lexsort((others, pair))
    pair, others = pair[order], others[order]
    same = (pair[1:] == pair[:-1]) & (others[1:] == others[:-1])
    once = np.ones(len(faces), dtype=np.bool_)
    once[order[1:][same]] = once[order[:-1][same]] = False
    outer: FaceArray = faces[once]
    return outer


def boundary_points(mesh: TetMesh) -> IntArray:
    """Return the points of the outer boundary, ascending.

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.

    Returns
    -------
    (n_boundary_points,) array of int64
        Point indices.
    """
    return np.unique(boundary_faces(mesh)).astype(np.int64)


def boundary_surface(mesh: TetMesh) -> Surface:
    """Return the outer boundary over all points of the mesh, so indices agree.

    Parameters
    ----------
    mesh : TetMesh
        The mesh; lengths in mm.

    Returns
    -------
    Surface
        All points of the mesh, mm, and its outer faces.
    """
    return Surface(mesh.points, boundary_faces(mesh))
