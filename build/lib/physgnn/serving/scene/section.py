"""A plane through the tetrahedra, as triangles that deform with them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from physgnn.arrays import FloatArray, IntArray
from physgnn.geometry import TetMesh

AXES: Mapping[str, int] = {"sagittal": 0, "coronal": 1, "axial": 2}
"""The world axis (RAS) that stands on each anatomical plane."""


@dataclass(frozen=True, eq=False)
class Section:
    """Triangles whose corners lie on edges of the mesh.

    Attributes
    ----------
    ends : (n, 2) integer array
        The two mesh points of the edge each corner lies on.
    share : (n,) array
        How far along it, 0 at the first.
    faces : (n_faces, 3) integer array
        Triangles, as indices of corners.
    region : (n_faces,) integer array
        Region of the cell each was cut from.
    """

    ends: IntArray
    share: FloatArray
    faces: IntArray
    region: IntArray

    def at(self, values: FloatArray) -> FloatArray:
        """Interpolate what is known at the mesh's points, (n_points, …)."""
        share = self.share.reshape(-1, *[1] * (values.ndim - 1))
        first, second = values[self.ends[:, 0]], values[self.ends[:, 1]]
        between: FloatArray = first + share * (second - first)
        return between


def cut(mesh: TetMesh, axis: str, offset_mm: float) -> Section:
    """Cut a mesh by a plane perpendicular to a world axis.

    Parameters
    ----------
    mesh : TetMesh
    axis : str
        A row of `AXES`.
    offset_mm : float
        Where the plane meets its axis; the section is empty outside the body.
    """
    height = mesh.points[:, AXES[axis]] - offset_mm
    above = height[mesh.cells] > 0
    count = above.sum(axis=1)
    # Corners of every cell with those below the plane first.
    order = np.argsort(above, axis=1, kind="stable")
    cells = np.take_along_axis(mesh.cells, order, axis=1).astype(np.int64)
    corners, cut_cells = [], []
    for n_above, triangles in CUTS.items():
        which = np.flatnonzero(count == n_above)
        for triangle in triangles:
            corners.append(np.sort(cells[which][:, triangle], axis=2))
            cut_cells.append(which)
    edges, index = np.unique(
        np.concatenate(corners).reshape(-1, 2), axis=0, return_inverse=True
    )
    start, end = height[edges].T
    return Section(
        ends=edges,
        share=start / np.where(start == end, 1.0, start - end),
        faces=index.reshape(-1, 3),
        region=mesh.region[np.concatenate(cut_cells)].astype(np.int64),
    )


# Corners of a cell above the plane → triangles, each corner on an edge (below, above)
# of the cell whose corners are sorted that way.
CUTS: Mapping[int, list[list[list[int]]]] = {
    1: [[[0, 3], [1, 3], [2, 3]]],
    2: [[[0, 2], [0, 3], [1, 3]], [[0, 2], [1, 3], [1, 2]]],
    3: [[[0, 1], [0, 2], [0, 3]]],
}
