"""POD–Galerkin with hyper-reduction: the classical reduced model, as a yardstick.

Modes of the training samples (proper orthogonal decomposition) span the body, the
points around loaded ones are unknowns of their own, a few weighted cells stand for all
(ECSW), and Newton's method finds the equilibrium in this space.
"""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.geometry.mesh_topology import points_within
from physgnn.learning.graph import Graph, as_float32
from physgnn.learning.interface import Model
from physgnn.mechanics.body import Body
from physgnn.mechanics.cell_selection import cell_works, weigh_cells
from physgnn.mechanics.galerkin import GalerkinBody
from physgnn.mechanics.loads import LoadCase
from physgnn.mechanics.modes import leading_modes

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_SNAPSHOTS = 600  # for the modes
MAX_STATES = 24  # for the weights: (modes × states × cells) numbers in memory


class GalerkinModel(Model):
    """Newton's method in the space of a few modes and the points near the loads.

    Parameters
    ----------
    body : Body
        What it's made for; its elements are tet4.
    modes : int
        How many.
    reach : int
        Points at most so many edges from a loaded one are unknowns themselves.
    tolerance : float
        Relative error of the weighted cells' work, in (0, 1).

    Raises
    ------
    InputError
        If an option is out of range.
    """

    near: Tensor
    modes: Tensor
    weights: Tensor

    def __init__(
        self, body: Body, *, modes: int = 64, reach: int = 1, tolerance: float = 0.01
    ) -> None:
        super().__init__()
        if modes < 1 or reach < 0 or not 0 < tolerance < 1:
            raise InputError(
                "modes must be ≥ 1, reach ≥ 0 and tolerance in (0, 1) "
                f"(got {modes}, {reach}, {tolerance})"
            )
        self.body = body
        self.reach, self.tolerance = reach, tolerance
        n = body.mesh.n_points
        self.register_buffer("near", torch.zeros(n, dtype=torch.bool))
        self.register_buffer("modes", torch.zeros(modes, n, 3))
        self.register_buffer("weights", torch.ones(body.mesh.n_cells))
        self._small: GalerkinBody | None = None

    def fit(self, store: Store, samples: IntArray) -> None:
        """Find the modes and the weights."""
        mesh, paths = store.mesh, np.unique(samples[:, 0])
        nodes = np.concatenate([store.load_path(int(path)).nodes for path in paths])
        near = points_within(mesh, np.unique(nodes), self.reach)
        near[self.body.fixed] = False
        modes = leading_modes(
            np.where(near[:, None], 0.0, _states(store, samples, MAX_SNAPSHOTS)),
            len(self.modes),
        )
        touching = near[mesh.cells].any(axis=1)
        works = [
            _scaled(cell_works(self.body.elements, u, modes.astype(np.float32)))
            for u in _states(store, samples, MAX_STATES)
        ]
        weights = np.ones(mesh.n_cells)
        weights[~touching] = weigh_cells(
            np.concatenate([part[:, ~touching] for part in works]), self.tolerance
        )
        self.near.copy_(torch.from_numpy(near))
        self.modes.copy_(as_float32(modes))
        self.weights.copy_(as_float32(weights))
        self._small = None

    def encode(self, load_case: LoadCase) -> Tensor:
        """Return the answer, (n_points, 3) float32, mm: all is done here."""
        if self._small is None:
            self._small = GalerkinBody(
                self.body.elements,
                self.weights.cpu().numpy().astype(np.float64),
                np.flatnonzero(self.near.cpu().numpy()),
                self.modes.cpu().numpy().astype(np.float64),
            )
        force = load_case.on_points(self.body.mesh.n_points)
        return as_float32(self._small.solve(force)[0])

    def forward(self, inputs: Tensor, graph: Graph) -> Tensor:  # noqa: ARG002
        """Return displacement in mm, (batch, n_points, 3)."""
        return inputs


def _states(store: Store, samples: IntArray, n_most: int) -> FloatArray:
    """Return displacements of samples evenly spread, (n, n_points, 3), mm."""
    picks = np.unique(np.linspace(0, len(samples) - 1, n_most).round().astype(int))
    return np.stack(
        [
            store.displacement(path)[level].astype(np.float64)
            for path, level in samples[picks].tolist()
        ]
    )


def _scaled(works: NDArray[np.float32]) -> NDArray[np.float32]:
    """Let every state count the same."""
    size = float(np.linalg.norm(works.sum(axis=1, dtype=np.float64)))
    return (works / max(size, 1e-30)).astype(np.float32)
