"""A cube of grid nodes about a body, and the ways between it and the body's points.

Trilinear interpolation takes fields from the nodes to the points. Its transpose,
divided by the weights that reach a node, takes values from points to the nodes: the
mean of the points in the cells about a node, the nearer ones counting more.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import FloatArray
from physgnn.learning.graph import as_float32

MARGIN = 1  # cells about the body on every side


@dataclass(frozen=True, eq=False)
class BodyGrid:
    """Nodes at equal distances along x, y and z.

    Attributes
    ----------
    origin : (3,) array
        The first node, mm.
    spacing : float
        Between neighbouring nodes, mm.
    nodes : int
        Along each axis.
    """

    origin: FloatArray
    spacing: float
    nodes: int

    @classmethod
    def about(cls, points: FloatArray, nodes: int) -> "BodyGrid":
        """Return the smallest cube about points (n, 3), mm, with a cell of margin."""
        low, high = points.min(axis=0), points.max(axis=0)
        cells = nodes - 1 - 2 * MARGIN
        spacing = float((high - low).max()) / cells
        origin = (low + high) / 2 - spacing * (nodes - 1) / 2
        return cls(origin, spacing, nodes)

    @property
    def positions(self) -> FloatArray:
        """Where the nodes are, (nodes³, 3), mm, z running fastest."""
        axis = self.spacing * np.arange(self.nodes)
        steps = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
        positions: FloatArray = self.origin + steps.reshape(-1, 3)
        return positions


class PointsOnGrid(nn.Module):
    """Points of a body in the cells of a grid.

    Parameters
    ----------
    grid : BodyGrid
        About the points.
    points : (n_points, 3) array
        Within the grid, mm.
    """

    corner: Tensor
    weight: Tensor

    def __init__(self, grid: BodyGrid, points: FloatArray) -> None:
        super().__init__()
        self.nodes = grid.nodes
        place = (points - grid.origin) / grid.spacing
        first = np.clip(np.floor(place).astype(np.int64), 0, grid.nodes - 2)
        inside = place - first
        corners, weights = [], []
        for step in product((0, 1), repeat=3):
            at = first + step
            corners.append((at[:, 0] * grid.nodes + at[:, 1]) * grid.nodes + at[:, 2])
            weights.append(np.where(step, inside, 1.0 - inside).prod(axis=1))
        corner = torch.from_numpy(np.stack(corners, axis=1))
        self.register_buffer("corner", corner, persistent=False)
        weight = as_float32(np.stack(weights, axis=1))
        self.register_buffer("weight", weight, persistent=False)

    def gather(self, fields: Tensor) -> Tensor:
        """Interpolate fields at the points.

        Parameters
        ----------
        fields : (batch, columns, nodes, nodes, nodes) tensor
            On the grid.

        Returns
        -------
        (batch, n_points, columns) tensor
        """
        at_corners = fields.flatten(2)[:, :, self.corner]
        gathered: Tensor = (at_corners * self.weight).sum(-1).transpose(1, 2)
        return gathered

    def scatter(self, values: Tensor, chosen: Tensor) -> tuple[Tensor, Tensor]:
        """Take values of chosen points to the nodes of their cells.

        Parameters
        ----------
        values : (batch, n_points, columns) tensor
            Those of points that are not chosen do not count.
        chosen : (batch, n_points) tensor
            1 where a point is chosen, else 0.

        Returns
        -------
        fields : (batch, columns, nodes, nodes, nodes) tensor
            The weighted mean of the chosen points about a node; 0 where there is none.
        reached : (batch, 1, nodes, nodes, nodes) tensor
            1 where there is one, else 0.
        """
        whole = torch.cat([values * chosen.unsqueeze(-1), chosen.unsqueeze(-1)], -1)
        spread = whole.unsqueeze(2) * self.weight.unsqueeze(-1)
        sums = whole.new_zeros(len(whole), self.nodes**3, whole.shape[-1])
        sums.index_add_(1, self.corner.flatten(), spread.flatten(1, 2))
        total = sums[..., -1:]
        reached = (total > 0).to(whole)
        means = sums[..., :-1] / torch.where(total > 0, total, 1.0)
        return self._cube(means), self._cube(reached)

    def _cube(self, columns: Tensor) -> Tensor:
        n = self.nodes
        return columns.transpose(1, 2).reshape(len(columns), -1, n, n, n)
