"""Prediction along a load path from the equilibria already found on it.

The path u(λ) is analytic away from limit points, so a polynomial through the last
few states predicts the next one to 1e-3 … 1e-5 mm. Which degree predicts best
changes along the path; it is chosen by looking back: the degree that would have
predicted the newest state best is used for the next one.
"""

import numpy as np

from physgnn.arrays import FloatArray

MAX_STATES = 8


class PathHistory:
    """The last few equilibria of a path, oldest first.

    Parameters
    ----------
    load_factor : float
        Where it begins.
    state : array
        The equilibrium there.
    """

    def __init__(self, load_factor: float, state: FloatArray) -> None:
        self.load_factors = [load_factor]
        self.states = [state]
        self._n_used = 1

    @property
    def newest(self) -> tuple[float, FloatArray]:
        """The load factor and state reached."""
        return self.load_factors[-1], self.states[-1]

    def add(self, load_factor: float, state: FloatArray) -> None:
        """Append an equilibrium and choose the degree for the next prediction."""
        if len(self.states) > 2:
            errors = [
                _largest(self._through_last(n, load_factor) - state)
                for n in range(2, len(self.states) + 1)
            ]
            self._n_used = 2 + int(np.argmin(errors))
        else:
            self._n_used = len(self.states) + 1
        self.load_factors.append(load_factor)
        self.states.append(state)
        del self.load_factors[:-MAX_STATES], self.states[:-MAX_STATES]

    def predict(self, load_factor: float) -> FloatArray:
        """Extrapolate to a load factor."""
        return self._through_last(min(self._n_used, len(self.states)), load_factor)

    def _through_last(self, n: int, load_factor: float) -> FloatArray:
        """Lagrange's polynomial through the last n states."""
        known = np.array(self.load_factors[-n:])
        gaps = known[:, None] - known + np.eye(n)
        ratios = (load_factor - known) / gaps
        np.fill_diagonal(ratios, 1.0)
        weights: FloatArray = ratios.prod(axis=1)
        total: FloatArray = sum(
            (w * s for w, s in zip(weights, self.states[-n:], strict=True)),
            start=np.zeros_like(self.states[-1]),
        )
        return total


def _largest(difference: FloatArray) -> float:
    return float(np.abs(difference).max())
