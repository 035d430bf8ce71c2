"""A convolutional network from the displacement of a surface to that of the volume.

After Pfeiffer et al., Int. J. Comput. Assist. Radiol. Surg. 14 (2019) 1147–1155: body
and known displacement are written on a regular grid, a fully convolutional network
gives the displacement on it, and it learns from random synthetic bodies. Lengths are
in cells of the grid, which is laid about the body: where a body is and how large it is
changes nothing.
"""

import numpy as np
import torch
from torch import Tensor

from physgnn.arrays import FloatArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.boundary import boundary_faces
from physgnn.geometry.surfaces.distances import signed_distance
from physgnn.learning.graph import Graph, as_float32
from physgnn.learning.grid_networks.grid import BodyGrid, PointsOnGrid
from physgnn.learning.grid_networks.known_surface import (
    known_displacement,
    seen_about,
)
from physgnn.learning.grid_networks.unet import UNet
from physgnn.learning.network import Network
from physgnn.learning.shared_weights import part_of_another
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.observed import ObservedLoadCase
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.loads.prescribed import PrescribedDisplacement

# Known displacement, where it is known, where the body is held, signed distance.
N_INPUTS = 3 + 1 + 1 + 1
FAR = 8.0  # cells from the surface that count as 1


class CNNModel(Network):
    """Displacement of the seen surface in, displacement of every point out.

    A sample of a dataset is told with the true displacement of the surface within 30 mm
    of the load. Where a load comes alone, the linear solution stands for it.

    Parameters
    ----------
    body : Body
        What is loaded.
    cells : int
        Nodes of the grid along each axis.
    width : int
        Columns on the finest grid.
    levels : int
        How often the grid is halved.
    matched : bool
        Learn from where the surface lies, not from which point is which: seen points
        go to the nearest places of the moved surface.

    Raises
    ------
    InputError
        If a number is too small, or 2 to the levels does not divide the cells.
    """

    shape: Tensor
    free: Tensor

    def __init__(
        self,
        body: Body,
        *,
        cells: int = 32,
        width: int = 16,
        levels: int = 3,
        matched: bool = False,
    ) -> None:
        super().__init__(body)
        if min(width, levels) < 1 or cells < 8 or cells % 2**levels:
            raise InputError(
                f"width and levels must be ≥ 1, cells ≥ 8 and a multiple of 2 to the "
                f"levels (got width {width}, levels {levels}, cells {cells})"
            )
        self.matched = matched
        points = body.mesh.points
        self.grid = grid = BodyGrid.about(points, cells)
        self.places = PointsOnGrid(grid, points)
        held = torch.zeros(1, len(points))
        held[0, body.fixed] = 1.0
        free = (1.0 - held[0]).unsqueeze(-1)
        self.register_buffer("free", free, persistent=False)
        self.register_buffer("shape", self._shape(held), persistent=False)
        self.network = UNet(N_INPUTS, 3, width=width, levels=levels)

    def _shape(self, held: Tensor) -> Tensor:
        """Return what depends on the body alone, (1, 2, n, n, n)."""
        grid, mesh = self.grid, self.body.mesh
        away = signed_distance(mesh.points, boundary_faces(mesh), grid.positions)
        distance = as_float32(away / (FAR * grid.spacing))
        _, skull = self.places.scatter(held.unsqueeze(-1), held)
        return torch.cat([skull, distance.view_as(skull)], dim=1)

    def sample_case(self, store: Store, path: int, level: int) -> LoadCase:
        """Return the load, and how the seen surface moved under it."""
        case = store.load_case(path, level)
        seen = known_displacement(store, path, level, matched=self.matched)
        return ObservedLoadCase(case.nodes, case.forces, seen)

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return how points moved, mm, and 1 where that is known, (n_points, 4)."""
        return self._columns(self._known(load_case))

    def _known(self, load_case: LoadCase) -> PrescribedDisplacement:
        if isinstance(load_case, ObservedLoadCase):
            return load_case.observed
        seen = seen_about(self.body, load_case)
        return PrescribedDisplacement(seen, self.linear(load_case)[seen])

    def _columns(self, known: PrescribedDisplacement) -> Tensor:
        columns = np.zeros((self.body.mesh.n_points, 4))
        columns[known.nodes, :3] = known.displacement
        columns[known.nodes, 3] = 1.0
        return as_float32(columns)

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:
        """Return displacement in mm, (batch, n_points, 3)."""
        graph.check_rows(inputs)
        spacing = self.grid.spacing
        known, seen = self.places.scatter(inputs[..., :3] / spacing, inputs[..., 3])
        shape = self.shape.expand(len(inputs), -1, -1, -1, -1)
        fields = self.network(torch.cat([known, seen, shape], dim=1))
        return self.places.gather(fields) * spacing * self.free

    @torch.inference_mode()
    def displacement_from(self, known: PrescribedDisplacement) -> FloatArray:
        """Return the displacement of all points from that of some, (n_points, 3), mm.

        Raises
        ------
        InputError
            If a point is missing from the mesh.
        """
        known.check_against(self.body.mesh)
        graph = self._graph_there()
        inputs = self._columns(known).to(graph.column.device).unsqueeze(0)
        displacement: FloatArray = self(inputs, graph)[0].cpu().numpy()
        return displacement.astype(np.float64)

    def share_weights(self, other: Surrogate) -> None:
        """Take another body's network's weights for one's own, in training too."""
        if not isinstance(other, CNNModel):
            raise InputError("a cnn takes the weights of another cnn")
        sizes = "width and levels"
        self.network = part_of_another(self.network, other.network, sizes)
