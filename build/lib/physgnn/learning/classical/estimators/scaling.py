"""Rows on scales that a learner can work with."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from physgnn.learning.classical.estimators.estimator import Rows
from physgnn.learning.surrogate import Arrays


@dataclass(frozen=True, eq=False)
class Scaling:
    """Inputs standardised; targets counted from their mean, all in one unit.

    One unit for all targets, so that a squared error keeps its meaning.

    Parameters
    ----------
    middle, width : (n_inputs,) float32 array
        Mean and standard deviation of the inputs; 1 where an input never changes.
    mean : (n_targets,) float32 array
        Of the targets.
    unit : float32
        Standard deviation of all targets about their means together.
    """

    middle: NDArray[np.float32]
    width: NDArray[np.float32]
    mean: NDArray[np.float32]
    unit: np.float32

    @classmethod
    def of(cls, inputs: Rows, targets: Rows) -> Self:
        """Return the scaling of (n, n_inputs) and (n, n_targets) rows."""
        width, mean = inputs.std(axis=0), targets.mean(axis=0)
        return cls(
            inputs.mean(axis=0),
            np.where(width > 0, width, 1.0).astype(np.float32),
            mean,
            np.float32((targets - mean).std() or 1.0),
        )

    def inputs(self, inputs: Rows) -> Rows:
        """Return inputs without units."""
        scaled: Rows = (inputs - self.middle) / self.width
        return scaled

    def targets(self, targets: Rows) -> Rows:
        """Return targets without units."""
        scaled: Rows = (targets - self.mean) / self.unit
        return scaled

    def back(self, scaled: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return targets in their own unit."""
        return scaled * self.unit + self.mean

    def arrays(self) -> Arrays:
        """Return all four, by name."""
        unit = np.array([self.unit])
        return {
            "middle": self.middle, "width": self.width, "mean": self.mean, "unit": unit
        }  # fmt: skip

    @classmethod
    def restored(cls, arrays: Arrays) -> Self:
        """Return the scaling that `arrays` wrote down."""
        return cls(arrays["middle"], arrays["width"], arrays["mean"], arrays["unit"][0])
