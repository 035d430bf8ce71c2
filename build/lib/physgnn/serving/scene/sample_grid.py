"""A regular grid of points inside a mesh, and interpolation from one to the other."""

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from scipy.sparse import csr_array

from physgnn.arrays import FloatArray
from physgnn.geometry import TetMesh


@dataclass(frozen=True, eq=False)
class SampleGrid:
    """A box of voxels around a mesh.

    Attributes
    ----------
    shape : three ints
        Voxels along x, y, z.
    origin : (3,) array
        World position of the first voxel's centre, mm.
    spacing_mm : float
        Between centres.
    weights : (n_voxels, n_points) sparse array
        Linear interpolation from mesh points to voxels, z slowest; empty rows outside.
    """

    shape: tuple[int, int, int]
    origin: FloatArray
    spacing_mm: float
    weights: csr_array

    @property
    def to_world(self) -> FloatArray:
        """The (4, 4) matrix from voxel indices (i, j, k) to world mm."""
        matrix = np.diag([*[self.spacing_mm] * 3, 1.0])
        matrix[:3, 3] = self.origin
        return matrix

    def at(self, values: FloatArray) -> FloatArray:
        """Interpolate (n_points, k) values; returns (n_z, n_y, n_x, k), 0 outside."""
        nx, ny, nz = self.shape
        inside: FloatArray = self.weights @ values
        return inside.reshape(nz, ny, nx, -1)


def grid_over(mesh: TetMesh, spacing_mm: float) -> SampleGrid:
    """Return a grid that covers a mesh."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    shape = np.ceil((high - low) / spacing_mm).astype(int) + 1
    axes = [low[i] + spacing_mm * np.arange(shape[i]) for i in range(3)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    centres = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    nx, ny, nz = shape.tolist()
    return SampleGrid((nx, ny, nz), low, spacing_mm, _weights(mesh, centres))


def _weights(mesh: TetMesh, places: FloatArray) -> csr_array:
    cells = {pv.CellType.TETRA: mesh.cells.astype(np.int64)}
    body = pv.UnstructuredGrid(cells, mesh.points)
    found = np.asarray(body.find_containing_cell(places))
    inside = np.flatnonzero(found >= 0)
    corners = mesh.cells[found[inside]]
    x = mesh.points[corners]
    edges = np.stack([x[:, a] - x[:, 0] for a in (1, 2, 3)], axis=-1)
    offset = (places[inside] - x[:, 0])[..., None]
    share = np.linalg.solve(edges, offset)[..., 0]
    share = np.concatenate([1 - share.sum(axis=1, keepdims=True), share], axis=1)
    rows = np.repeat(inside, 4)
    shape = (len(places), mesh.n_points)
    return csr_array((share.ravel(), (rows, corners.ravel())), shape=shape)
