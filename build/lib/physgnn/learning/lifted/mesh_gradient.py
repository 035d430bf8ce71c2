"""Mean over neighbours and discrete gradient on a patch of the mesh, as one matrix."""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from physgnn.arrays import FloatArray
from physgnn.geometry.tetmesh import shape_gradients

CellArray = NDArray[np.integer[Any]]


@dataclass(frozen=True, eq=False)
class Stencil:
    """Four rows a point: its neighbours' mean less its own value, and ℓ ∂/∂(x, y, z).

    The gradient at a point is the volume-weighted mean of its cells' constant ones; ℓ,
    the mean length of its edges, makes it dimensionless, so that meshes of any density
    look alike.

    Attributes
    ----------
    matrix, transposed : sparse (4 n, n) and (n, 4 n) float32 tensors
        Row 4 i + c is component c at point i.
    """

    matrix: Tensor
    transposed: Tensor

    @classmethod
    def from_cells(cls, points: FloatArray, cells: CellArray) -> "Stencil":
        """Build it for points and the cells among them, on the CPU."""
        n = len(points)
        rows = sp.vstack(
            [_neighbour_mean(cells, n), *_gradient(points, cells)], format="csr"
        )
        order = np.arange(4 * n).reshape(4, n).T.ravel()
        matrix = rows[order].tocsr()
        return cls(_to_torch(matrix), _to_torch(matrix.T.tocsr()))

    def to(self, device: torch.device | str) -> "Stencil":
        """Return the stencil on a device."""
        return Stencil(self.matrix.to(device), self.transposed.to(device))

    def __call__(self, x: Tensor) -> Tensor:
        """Apply to every sample: (batch, n, columns) → (batch, n, 4 · columns).

        One sample at a time: its columns stay in cache, which beats one wide product.
        """
        product: Any = _Product.apply
        return torch.stack(
            [product(self.matrix, self.transposed, s).view(len(s), -1) for s in x]
        )


class _Product(torch.autograd.Function):
    """matrix @ x, with a transpose made once rather than at every backward pass."""

    @staticmethod
    def forward(ctx: Any, matrix: Tensor, transposed: Tensor, x: Tensor) -> Tensor:
        ctx.transposed = transposed
        return matrix @ x

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[None, None, Tensor]:
        return None, None, ctx.transposed @ grad.contiguous()


def edge_lengths(points: FloatArray, cells: CellArray) -> FloatArray:
    """Return the mean length of the edges at each point, (n_points,) mm."""
    adjacent = _adjacency(cells, len(points)).tocoo()
    length = np.linalg.norm(points[adjacent.row] - points[adjacent.col], axis=1)
    total = np.bincount(adjacent.row, length, minlength=len(points))
    count = np.bincount(adjacent.row, minlength=len(points))
    mean: FloatArray = total / np.maximum(count, 1)
    return mean


def _adjacency(cells: CellArray, n: int) -> sp.csr_array:
    start, end = np.repeat(cells, 4, axis=1).ravel(), np.tile(cells, 4).ravel()
    edge = start != end
    ones = np.ones(edge.sum())
    matrix = sp.coo_array((ones, (start[edge], end[edge])), shape=(n, n)).tocsr()
    matrix.data[:] = 1.0  # cells share edges
    return matrix


def _neighbour_mean(cells: CellArray, n: int) -> sp.csr_array:
    adjacent = _adjacency(cells, n)
    count = np.maximum(adjacent.sum(axis=1), 1.0)
    return (sp.diags_array(1.0 / count) @ adjacent - sp.eye_array(n)).tocsr()


def _gradient(points: FloatArray, cells: CellArray) -> list[sp.csr_array]:
    n = len(points)
    x = points[cells]
    volume = np.abs(np.linalg.det(x[:, 1:] - x[:, :1])) / 6
    share = np.bincount(cells.ravel(), np.repeat(volume, 4), minlength=n)
    scale = edge_lengths(points, cells) / np.where(share > 0, share, 1.0)
    row, column = np.repeat(cells, 4, axis=1).ravel(), np.tile(cells, 4).ravel()
    gradients = shape_gradients(points, cells) * volume[:, None, None]
    return [
        sp.diags_array(scale)
        @ sp.coo_array(
            (np.tile(gradients[:, :, c], 4).ravel(), (row, column)), shape=(n, n)
        ).tocsr()
        for c in range(3)
    ]


def _to_torch(matrix: sp.csr_array) -> Tensor:
    matrix.sort_indices()
    with torch.inference_mode(False), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Sparse CSR tensor support is in beta")
        return torch.sparse_csr_tensor(
            torch.from_numpy(matrix.indptr.astype(np.int64)),
            torch.from_numpy(matrix.indices.astype(np.int64)),
            torch.from_numpy(matrix.data.astype(np.float32)),
            matrix.shape,
            check_invariants=True,
        )
