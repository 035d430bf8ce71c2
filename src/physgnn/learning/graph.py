"""A mesh as a graph: its edges once, shared by every sample and every layer."""

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh


def as_float32(array: NDArray[np.float64]) -> Tensor:
    """Cast to float32: the one place where mechanics' float64 ends."""
    return torch.from_numpy(np.ascontiguousarray(array, dtype=np.float32))


@dataclass(frozen=True, eq=False)
class Graph:
    """Points joined by tetrahedron edges, both ways, in compressed rows.

    Row i lists the neighbours of point i: ``column[row_start[i]:row_start[i + 1]]``.

    Attributes
    ----------
    row_start : (n_points + 1,) int64 tensor
        Where each row begins.
    column : (n_edges,) int64 tensor
        Neighbours, ascending within a row.
    weight : (n_edges,) float32 tensor
        1 / edge length, 1/mm.
    """

    row_start: Tensor
    column: Tensor
    weight: Tensor

    @classmethod
    def from_mesh(cls, mesh: TetMesh) -> "Graph":
        """Return the graph of a mesh, on the CPU."""
        start, end = _edges(mesh.cells)
        length = np.linalg.norm(mesh.points[end] - mesh.points[start], axis=1)
        return cls(
            torch.from_numpy(np.searchsorted(start, np.arange(mesh.n_points + 1))),
            torch.from_numpy(end),
            as_float32(1.0 / length),
        )

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.row_start) - 1

    @property
    def n_edges(self) -> int:
        """Number of directed edges."""
        return len(self.column)

    @property
    def edge_index(self) -> Tensor:
        """Edges as (2, n_edges) rows of source and target, as PyTorch Geometric has."""
        target = torch.arange(self.n_points, device=self.column.device)
        return torch.stack(
            [self.column, target.repeat_interleave(self.row_start.diff())]
        )

    @cached_property
    def weighted(self) -> Tensor:
        """Sparse (n_points, n_points) matrix of 1 / edge length; symmetric."""
        return self._matrix(self.weight)

    @cached_property
    def plain(self) -> Tensor:
        """Sparse (n_points, n_points) matrix of ones where there's an edge."""
        return self._matrix(torch.ones(self.n_edges).to(self.weight))

    def _matrix(self, values: Tensor) -> Tensor:
        # Kept for training as well, wherever it was first asked for.
        with torch.inference_mode(False), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Sparse CSR tensor support is in beta")
            return torch.sparse_csr_tensor(
                self.row_start,
                self.column,
                values.clone(),
                (self.n_points,) * 2,
                check_invariants=True,
            )

    def to(self, device: torch.device | str) -> "Graph":
        """Return the graph on a device."""
        return Graph(
            *(t.to(device) for t in (self.row_start, self.column, self.weight))
        )

    def check_rows(self, x: Tensor) -> None:
        """Raise InputError unless x is (batch, n_points, columns)."""
        if x.ndim != 3 or x.shape[1] != self.n_points:
            raise InputError(
                f"expected one row a point, (batch, {self.n_points}, columns) "
                f"(got {tuple(x.shape)}); the graph may be of another mesh"
            )


def _edges(cells: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return start and end of every edge both ways, sorted by start, then end."""
    n_points = int(cells.max()) + 1
    pairs = [(i, j) for i in range(4) for j in range(4) if i != j]
    wide = cells.astype(np.int64)
    keys = np.unique(
        np.concatenate([wide[:, i] * n_points + wide[:, j] for i, j in pairs])
    )
    return keys // n_points, keys % n_points
