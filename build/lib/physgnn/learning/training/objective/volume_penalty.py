"""A cost for cells that a prediction flattens or turns inside out.

The strain energy of a nearly incompressible body forbids det F → 0, but a network
that is taught displacements alone is not told: a tenth of a millimetre is a small error
and may be enough to invert a small cell. The energy itself has no slope that training
could use once a cell is inverted; this cost, a parabola below `SMALLEST`, has.
"""

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import as_float32

SMALLEST = 0.3  # det F below which a cell costs; few true ones are there


class VolumePenalty(nn.Module):
    """Mean over samples of Σ_cells max(J₀ − det F, 0)².

    Parameters
    ----------
    mesh : TetMesh
    """

    cells: Tensor
    points: Tensor
    volumes: Tensor

    def __init__(self, mesh: TetMesh) -> None:
        super().__init__()
        cells = torch.from_numpy(mesh.cells.astype(np.int64))
        self.register_buffer("cells", cells, persistent=False)
        self.register_buffer("points", as_float32(mesh.points), persistent=False)
        six_volumes = as_float32(6 * mesh.cell_volumes)
        self.register_buffer("volumes", six_volumes, persistent=False)

    def forward(self, displacement: Tensor) -> Tensor:
        """Return the cost of displacements (batch, n_points, 3) in mm."""
        ratio = self.volume_ratio(displacement)
        cost: Tensor = (SMALLEST - ratio).clamp_min(0.0).square().sum(dim=-1).mean()
        return cost

    def volume_ratio(self, displacement: Tensor) -> Tensor:
        """Return det F of every cell, (batch, n_cells)."""
        moved = (self.points + displacement)[:, self.cells]
        a, b, c = (moved[:, :, i] - moved[:, :, 0] for i in (1, 2, 3))
        ratio: Tensor = torch.linalg.cross(a, b).mul(c).sum(dim=-1) / self.volumes
        return ratio
