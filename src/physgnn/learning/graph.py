"""A mesh as a graph: its edges once, shared by every sample and every layer."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
import scipy.sparse as sp
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.arrays import FloatArray, IntArray
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.body import Body


def as_float32(array: FloatArray) -> Tensor:
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
    n_columns : int
        Points that neighbours are among: all of them, unless the graph was cut.
    """

    row_start: Tensor
    column: Tensor
    weight: Tensor
    n_columns: int

    @classmethod
    def from_mesh(cls, mesh: TetMesh) -> "Graph":
        """Return the graph of a mesh, on the CPU."""
        start, end = _edges(mesh.cells)
        length = np.linalg.norm(mesh.points[end] - mesh.points[start], axis=1)
        return cls(
            torch.from_numpy(np.searchsorted(start, np.arange(mesh.n_points + 1))),
            torch.from_numpy(end),
            as_float32(1.0 / length),
            mesh.n_points,
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
    def row(self) -> Tensor:
        """The point each edge belongs to, (n_edges,)."""
        points = torch.arange(self.n_points, device=self.column.device)
        return points.repeat_interleave(self.row_start.diff())

    @property
    def edge_index(self) -> Tensor:
        """Edges as (2, n_edges) rows of source and target, as PyTorch Geometric has."""
        return torch.stack([self.column, self.row])

    @cached_property
    def weighted(self) -> Tensor:
        """The (n_points, n_columns) sparse matrix of 1 / edge length."""
        return self._matrix(torch.clone)

    @cached_property
    def plain(self) -> Tensor:
        """The (n_points, n_columns) sparse matrix of ones."""
        return self._matrix(torch.ones_like)

    def to(self, device: torch.device | str) -> "Graph":
        """Return the graph on a device."""
        return Graph(
            self.row_start.to(device),
            self.column.to(device),
            self.weight.to(device),
            self.n_columns,
        )

    def reordered(self, order: Tensor) -> "Graph":
        """Return the same graph with points renamed, ``order[new] = old``."""
        new = torch.argsort(order)
        row, column = new[self.row], new[self.column]
        edges = torch.argsort(row * self.n_columns + column)
        start = _row_start(row, self.n_points)
        return Graph(start, column[edges], self.weight[edges], self.n_columns)

    def cut(self, n_points: int, n_columns: int) -> "Graph":
        """Return the first rows, whose neighbours are all among the first columns."""
        end = int(self.row_start[n_points])
        start = self.row_start[: n_points + 1]
        return Graph(start, self.column[:end], self.weight[:end], n_columns)

    def check_rows(self, x: Tensor) -> None:
        """Raise InputError unless x is (batch, n_points, columns)."""
        if x.ndim != 3 or x.shape[1] != self.n_points:
            raise InputError(
                f"expected one row a point, (batch, {self.n_points}, columns) "
                f"(got {tuple(x.shape)}); the graph may be of another mesh"
            )

    def _matrix(self, values: Callable[[Tensor], Tensor]) -> Tensor:
        shape = self.n_points, self.n_columns
        # Serves training as well, wherever it was first asked for.
        with torch.inference_mode(False), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Sparse (CSR|invariant)")
            value = values(self.weight)
            return torch.sparse_csr_tensor(self.row_start, self.column, value, shape)


_graphs: WeakKeyDictionary[TetMesh, Graph] = WeakKeyDictionary()


def graph_of(body: Body) -> Graph:
    """Return the graph of a body's mesh, on the CPU; it is made once a mesh."""
    if body.mesh not in _graphs:
        _graphs[body.mesh] = Graph.from_mesh(body.mesh)
    return _graphs[body.mesh]


def _edges(cells: NDArray[np.int32]) -> tuple[IntArray, IntArray]:
    """Return start and end of every edge both ways, sorted by start, then end."""
    n = int(cells.max()) + 1
    pairs = [(i, j) for i in range(4) for j in range(4) if i != j]
    start, end = (np.concatenate([cells[:, pair[k]] for pair in pairs]) for k in (0, 1))
    once = np.ones(len(start), dtype=np.int8)
    matrix = sp.coo_array((once, (start, end)), shape=(n, n)).tocsr()
    matrix.sort_indices()
    row = np.repeat(np.arange(n), np.diff(matrix.indptr))
    return row, matrix.indices.astype(np.int64)


def _row_start(row: Tensor, n_rows: int) -> Tensor:
    counts = torch.bincount(row, minlength=n_rows)
    return torch.cat([counts.new_zeros(1), counts.cumsum(0)])
