"""The baseline that shows what a split gives away."""

import numpy as np
from numpy.typing import NDArray

from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.mechanics.loads import LoadCase

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SAME_DIRECTION = 1 - 1e-10  # cosine between two force fields of the same load path


class LevelInterpolation:
    """Interpolates between the neighbouring training levels of the same load path.

    It has learnt nothing: what it reaches is what a split gives away (PROTOCOL §9).
    The rest state counts as a training level; above the highest one the last two are
    extrapolated.

    Parameters
    ----------
    store : Store
    train : (n, 2) integer array
        Rows of (path, level) it may look up.
    """

    def __init__(self, store: Store, train: IntArray) -> None:
        self._store = store
        self._levels = {
            int(path): np.sort(train[train[:, 0] == path, 1])
            for path in np.unique(train[:, 0])
        }

    def __call__(self, load_case: LoadCase) -> FloatArray:
        """Return the interpolated displacement.

        Raises
        ------
        InputError
            If no training sample lies on this load's path.
        """
        path, factor = self._find(load_case)
        levels = self._levels[path]
        factors = np.concatenate([[0.0], self._store.load_factors[levels]])
        above = int(np.clip(np.searchsorted(factors, factor), 1, len(factors) - 1))
        weight = (factor - factors[above - 1]) / (factors[above] - factors[above - 1])
        known = self._store.displacement(path)
        upper = known[levels[above - 1]]
        lower = known[levels[above - 2]] if above > 1 else np.zeros_like(upper)
        answer: FloatArray = lower + weight * (upper.astype(np.float64) - lower)
        return answer

    def _find(self, case: LoadCase) -> tuple[int, float]:
        """Return the path whose forces are parallel to the case's, and the factor."""
        size = float(np.linalg.norm(case.forces))
        for path in self._levels:
            known = self._store.load_path(path)
            if not np.array_equal(known.nodes, case.nodes):
                continue
            full = float(np.linalg.norm(known.forces))
            if np.vdot(known.forces, case.forces) >= SAME_DIRECTION * full * size:
                return path, size / full
        raise InputError(
            "level interpolation needs training samples on the load's own path "
            "(got none): leave it out of this split"
        )
