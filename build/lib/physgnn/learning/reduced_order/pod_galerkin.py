"""POD–Galerkin with hyper-reduction: the classical reduced model, as a yardstick.

Modes of the training samples (proper orthogonal decomposition) span the body, the
points around loaded ones are unknowns of their own, a few weighted cells stand for all
(ECSW), and Newton's method finds the equilibrium in this space.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.mesh_topology import points_within
from physgnn.learning.surrogate import Arrays, Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import DEFAULT_ELEMENT
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.reduced.pod_galerkin.ecsw import cell_works, weigh_cells
from physgnn.mechanics.reduced.pod_galerkin.galerkin import GalerkinBody
from physgnn.mechanics.reduced.pod_galerkin.pod import leading_modes

MAX_SNAPSHOTS = 600  # for the modes
MAX_STATES = 24  # for the weights: (modes × states × cells) numbers in memory


@dataclass(frozen=True, eq=False)
class _Solved:
    """A load (n_points, 3), N, what it leads to, mm, and whether that converged."""

    force: FloatArray
    displacement: FloatArray
    converged: bool


class GalerkinModel(Surrogate):
    """Newton's method in the space of a few POD modes and the points near the loads.

    Parameters
    ----------
    body : Body
        What it's made for; its elements are tet4.
    pod_modes : int
        How many.
    k_hops : int
        Points in the k-hop neighbourhood of the loaded ones, at most so many edges from
        one of them, are unknowns themselves.
    tolerance : float
        Relative error of the weighted cells' work, in (0, 1).

    Raises
    ------
    InputError
        If an option is out of range.
    """

    elements = (DEFAULT_ELEMENT,)
    zero_without_load = True

    def __init__(
        self,
        body: Body,
        *,
        pod_modes: int = 64,
        k_hops: int = 1,
        tolerance: float = 0.01,
    ) -> None:
        super().__init__(body)
        if pod_modes < 1 or k_hops < 0 or not 0 < tolerance < 1:
            raise InputError(
                "pod_modes must be ≥ 1, k_hops ≥ 0 and tolerance in (0, 1) "
                f"(got {pod_modes}, {k_hops}, {tolerance})"
            )
        self.k_hops, self.tolerance = k_hops, tolerance
        n = body.mesh.n_points
        self.near = np.zeros(n, dtype=bool)
        self.modes = np.zeros((pod_modes, n, 3), dtype=np.float32)
        self.weights = np.ones(body.mesh.n_cells, dtype=np.float32)
        self._small: GalerkinBody | None = None
        self._last: _Solved | None = None

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Find the modes and the weights."""
        del seed
        mesh, paths = store.mesh, np.unique(samples[:, 0])
        nodes = np.concatenate([store.load_path(int(path)).nodes for path in paths])
        near = points_within(mesh, np.unique(nodes), self.k_hops)
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
        self.restore(
            {
                "near": near,
                "modes": modes.astype(np.float32),
                "weights": weights.astype(np.float32),
            }
        )

    def arrays(self) -> Arrays:
        """Return the points that are unknowns themselves, modes, and cells' weights."""
        return {"near": self.near, "modes": self.modes, "weights": self.weights}

    def restore(self, arrays: Arrays) -> None:
        """Take points, modes and weights."""
        self.near, self.modes = arrays["near"], arrays["modes"]
        self.weights = arrays["weights"]
        self._small = self._last = None

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the equilibrium in the small space, (n_points, 3), mm."""
        return self._solved(load_case).displacement.copy()

    def is_sound(self, load_case: LoadCase) -> bool:
        """Return whether Newton's method converged in the small space."""
        return self._solved(load_case).converged

    def _solved(self, load_case: LoadCase) -> _Solved:
        """Solve, unless this very load was the last one solved."""
        force = load_case.on_points(self.body.mesh.n_points)
        if self._last is None or not np.array_equal(self._last.force, force):
            u, found = self._made().solve(force)
            self._last = _Solved(force, u, found.converged)
        return self._last

    def _made(self) -> GalerkinBody:
        if self._small is None:
            self._small = GalerkinBody(
                self.body.elements,
                self.weights.astype(np.float64),
                np.flatnonzero(self.near),
                self.modes.astype(np.float64),
            )
        return self._small


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
