"""What a learner of rows must offer."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from physgnn.learning.surrogate import Arrays

Rows = NDArray[np.float32]


class Estimator(Protocol):
    """A learner of rows, as scikit-learn's, that can be written down as arrays."""

    def fit(self, inputs: Rows, targets: Rows) -> Any:
        """Learn from (n, n_inputs) and (n, n_targets)."""
        ...

    def predict(self, inputs: Rows) -> NDArray[np.floating]:
        """Return (n, n_targets)."""
        ...

    def arrays(self) -> Arrays:
        """Return what was learnt."""
        ...

    def restore(self, arrays: Arrays) -> None:
        """Take what `arrays` returned."""
        ...
