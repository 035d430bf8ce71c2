"""Linear elasticity, u = K₀⁻¹ f: the baseline no network may lose to."""

from physgnn.arrays import FloatArray
from physgnn.learning.surrogate import Surrogate
from physgnn.mechanics.loads.paths import LoadCase


class Linear(Surrogate):
    """The linear solution.

    K₀ is factorised once, for the first prediction; each costs one back-solve.
    """

    learns = False
    zero_without_load = True

    def predict(self, load_case: LoadCase) -> FloatArray:
        """Return K₀⁻¹ f, (n_points, 3), mm."""
        return self.linear(load_case)
