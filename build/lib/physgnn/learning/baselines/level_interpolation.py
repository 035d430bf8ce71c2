"""The baseline that shows what a split gives away."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from physgnn.arrays import FloatArray, IntArray
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.surrogate import Arrays, Surrogate
from physgnn.mechanics.body import Body
from physgnn.mechanics.loads.paths import LoadCase

SAME_DIRECTION = 1 - 1e-10  # cosine between two force fields of the same load path

Known = Callable[[int], NDArray[np.float32]]  # from a sample's row, mm


class LevelInterpolation(Surrogate):
    """Interpolates between the neighbouring training levels of the same load path.

    It has learnt nothing: what it reaches is what a split gives away (PROTOCOL §9).
    The rest state counts as a training level; above the highest one the last two are
    extrapolated. `fit` reads nothing: a level is read from the store when it is needed.
    """

    learns = False
    zero_without_load = True
    _known: Known

    def __init__(self, body: Body) -> None:
        super().__init__(body)
        self.restore(
            {
                "factors": np.empty(0),
                "path": np.empty(0, dtype=np.int64),
                "forces": np.empty((0, body.mesh.points.size)),
                "displacement": np.empty((0, *body.mesh.points.shape), np.float32),
            }
        )

    def fit(self, store: Store, samples: IntArray, seed: int = 0) -> None:
        """Remember which levels of which load paths may be looked up."""
        del seed
        samples = samples[np.lexsort((samples[:, 1], samples[:, 0]))]
        paths, self._path = np.unique(samples[:, 0], return_inverse=True)
        self._factors = store.load_factors[samples[:, 1]]
        self._forces = np.zeros((len(paths), *self.body.mesh.points.shape))
        for forces, number in zip(self._forces, paths.tolist(), strict=True):
            path = store.load_path(number)
            forces[path.nodes] = path.forces
        self._forces = self._forces.reshape(len(paths), -1)

        def known(row: int) -> NDArray[np.float32]:
            path, level = samples[row].tolist()
            found: NDArray[np.float32] = store.displacement(path)[level]
            return found

        self._known = known

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return the interpolated displacement.

        Raises
        ------
        InputError
            If no training sample lies on this load's path.
        """
        path, factor = self._find(load_case)
        rows = np.flatnonzero(self._path == path)
        factors = np.concatenate([[0.0], self._factors[rows]])
        above = int(np.clip(np.searchsorted(factors, factor), 1, len(rows)))
        weight = (factor - factors[above - 1]) / (factors[above] - factors[above - 1])
        upper = self._known(int(rows[above - 1])).astype(np.float64)
        lower = self._known(int(rows[above - 2])) if above > 1 else np.zeros_like(upper)
        displacement: FloatArray = lower + weight * (upper - lower)
        return displacement

    def _find(self, case: LoadCase) -> tuple[int, float]:
        """Return the path whose forces are parallel to the case's, and the factor."""
        force = case.on_points(self.body.mesh.n_points).ravel()
        size, full = np.linalg.norm(force), np.linalg.norm(self._forces, axis=1)
        parallel = (full > 0) & (self._forces @ force >= SAME_DIRECTION * full * size)
        if not parallel.any():
            raise InputError(
                "level interpolation needs training samples on the load's own path "
                "(got none): take split published or node, whose paths are trained on"
            )
        path = int(parallel.argmax())
        return path, float(size / full[path])

    def arrays(self) -> Arrays:
        """Return load factor, path and displacement of the samples, and the loads."""
        known = [self._known(row) for row in range(len(self._path))]
        return {
            "factors": self._factors,
            "path": self._path,
            "forces": self._forces,
            "displacement": np.stack(known),
        }

    def restore(self, arrays: Arrays) -> None:
        """Look displacements up in memory."""
        self._factors, self._path = arrays["factors"], arrays["path"]
        self._forces = arrays["forces"]
        self._known = arrays["displacement"].__getitem__

    def warm_up_cases(self) -> Iterator[LoadCase]:
        """Yield nothing: there is nothing to warm up, and other loads are refused."""
        return iter(())

    @classmethod
    def applies_to(cls, store: Store, train: IntArray, test: IntArray) -> bool:
        """Return whether some levels of every tested path are trained on."""
        del store
        return bool(np.isin(test[:, 0], train[:, 0]).all())
