"""The local part of the lifted network: a few layers on the points near the loads."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from physgnn.arrays import BoolArray, FloatArray
from physgnn.geometry.tetmesh import shape_gradients
from physgnn.learning.graph import as_float32
from physgnn.learning.lifted.mesh_gradient import Stencil, edge_lengths
from physgnn.mechanics.body import Body

N_STATIC = 4
N_FEATURES = 3 * 12 + 3 + 3 + N_STATIC  # and 6 of the imbalance
TELLING = 10.0  # times the force that strains a cell by 1: an imbalance is that small
MOST = 1e6  # of a ratio: under next to no load, rounding over the second term
REFERENCE_MU = 1e-3  # MPa; that of brain tissue, so that features are about 1


@dataclass(frozen=True, eq=False)
class NetworkRegion:
    """The part of a mesh that a network works on, and what it's told of it.

    Attributes
    ----------
    points : (n,) int64 tensor
        Indices of its points in the mesh.
    stencil : Stencil
        Neighbours' mean and gradient within the patch.
    length : (n, 1) tensor
        Mean edge length at each point, mm.
    stiffness : (n, 1) tensor
        Force that strains a point's surroundings by about 1: μ ℓ², N.
    static : (n, 4) tensor
        Outward surface area vector over ℓ² (zero inside), and log μ / 1 kPa.
    """

    points: Tensor
    stencil: Stencil
    length: Tensor
    stiffness: Tensor
    static: Tensor

    @classmethod
    def of(cls, body: Body, near: BoolArray) -> "NetworkRegion":
        """Cut the cells all of whose points are near out of a body's mesh."""
        mesh = body.mesh
        inside = near[mesh.cells].all(axis=1)
        points = np.unique(mesh.cells[inside])
        cells = np.searchsorted(points, mesh.cells[inside])
        length = edge_lengths(mesh.points, mesh.cells)
        mu = _shear_modulus(body)
        area = _outward_area(body) / length[:, None] ** 2
        static = np.column_stack([area, np.log(mu / REFERENCE_MU)])
        return cls(
            torch.from_numpy(points.astype(np.int64)),
            Stencil.from_cells(mesh.points[points], cells),
            as_float32(length[points, None]),
            as_float32((mu * length**2)[points, None]),
            as_float32(static[points]),
        )

    def to(self, device: torch.device | str) -> "NetworkRegion":
        """Return the patch on a device."""
        return NetworkRegion(
            self.points.to(device),
            self.stencil.to(device),
            self.length.to(device),
            self.stiffness.to(device),
            self.static.to(device),
        )


class LiftedNetwork(nn.Module):
    """Predicts, near the loads, what an expansion misses, in units of its last term.

    It is a displacement there and, if wanted, a force, which moves the body elsewhere.

    Everything it sees is local and dimensionless: gradients of the expansion's terms,
    the second term's shape, force over stiffness, and what the body is there.

    Parameters
    ----------
    width, n_layers : int
        Columns between layers, and number of layers.
    forces : bool
        Whether it predicts forces, too.
    imbalance : bool
        Whether it sees what force the expansion leaves out of balance, too.
    """

    def __init__(
        self, width: int, n_layers: int, *, forces: bool, imbalance: bool
    ) -> None:
        super().__init__()
        message = (width + 1) // 2  # neighbours are told half: it costs half
        self.first = nn.Linear(N_FEATURES + 6 * imbalance, width)
        self.messages = nn.ModuleList(
            nn.Linear(width, message, bias=False) for _ in range(n_layers)
        )
        self.layers = nn.ModuleList(
            nn.Linear(width + 4 * message, width) for _ in range(n_layers)
        )
        self.last = nn.Linear(width, 6 if forces else 3)
        nn.init.zeros_(self.last.weight)  # training starts from the expansion
        nn.init.zeros_(self.last.bias)

    def forward(
        self, terms: Tensor, force: Tensor, size: Tensor, patch: NetworkRegion
    ) -> tuple[Tensor, Tensor]:
        """Return the correction over its size, and the force over the same size.

        Parameters
        ----------
        terms : (batch, n, 9) tensor
            Anchor, with the third term if there is one, first and second term at the
            patch's points, mm.
        force : (batch, n, 3) or (batch, n, 6) tensor
            The load and, if it sees that, the imbalance, N.
        size : (batch, 1, 1) tensor
            Of the second term, mm.
        patch : NetworkRegion
            The points.

        Returns
        -------
        displacement : (batch, n, 3) tensor
            Per mm of the second term.
        force : (batch, n, 3) or (batch, n, 0) tensor
            N per mm of it.
        """
        h = self.first(_features(terms, force, size, patch))
        for message, layer in zip(self.messages, self.layers, strict=True):
            around = patch.stencil(message(h))
            h = h + nn.functional.silu(layer(torch.cat([h, around], dim=-1)))
        displacement, force = self.last(h).tensor_split([3], dim=-1)
        return displacement, patch.stiffness / patch.length * force


def _features(
    terms: Tensor, force: Tensor, size: Tensor, patch: NetworkRegion
) -> Tensor:
    gradients = patch.stencil(terms) / patch.length
    size = size.clamp_min(torch.finfo(terms.dtype).tiny)
    static = patch.static.expand(len(terms), -1, -1)
    load, left = (force / patch.stiffness).tensor_split([3], dim=-1)
    columns = [gradients, terms[..., 6:] / size, load]
    if left.shape[-1]:
        relative = (left * patch.length / size).clamp(-MOST, MOST)
        columns += [_shortened(TELLING * left), _shortened(relative)]
    return torch.cat([*columns, static], dim=-1)


def _shortened(vector: Tensor) -> Tensor:
    """Return a vector with a length x shortened to arsinh x: few are much longer."""
    length = torch.linalg.vector_norm(vector, dim=-1, keepdim=True)
    length = length.clamp_min(torch.finfo(vector.dtype).tiny)
    shortened: Tensor = vector * (torch.asinh(length) / length)
    return shortened


def _shear_modulus(body: Body) -> FloatArray:
    """Return the mean shear modulus of the cells at each point, MPa."""
    mesh = body.mesh
    modulus = np.zeros(mesh.n_cells)
    for region, material in body.materials.items():
        modulus[mesh.region == region] = material.mu
    total = np.bincount(
        mesh.cells.ravel(), np.repeat(modulus, 4), minlength=mesh.n_points
    )
    count = np.bincount(mesh.cells.ravel(), minlength=mesh.n_points)
    mean: FloatArray = total / count
    return mean


def _outward_area(body: Body) -> FloatArray:
    """Return ∫ N n dA at each point, mm²: by Gauss, the sum of V ∂N/∂X over cells."""
    mesh = body.mesh
    parts = shape_gradients(mesh.points, mesh.cells) * mesh.cell_volumes[:, None, None]
    area = np.zeros_like(mesh.points)
    np.add.at(area, mesh.cells.ravel(), parts.reshape(-1, 3))
    return area
