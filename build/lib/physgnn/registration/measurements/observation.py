"""What a measurement says of a displacement, linearised about any state."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.sparse import csr_array, vstack

from physgnn.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Observation:
    """Components of the displacement of some places, and what they lack.

    Attributes
    ----------
    places : (n, n_points) sparse array
        From values on mesh points to values at the places.
    axes : (n, k, 3) array
        The k directions measured at each place.
    missing : (n, k) array
        Measured minus present component, mm.
    """

    places: csr_array
    axes: FloatArray
    missing: FloatArray

    def of(self, field: FloatArray) -> FloatArray:
        """Return the components of a displacement (n_points, 3), shape (n, k)."""
        seen: FloatArray = np.einsum("nki,ni->nk", self.axes, self.places @ field)
        return seen

    def after(self, step: FloatArray) -> "Observation":
        """Return what is left after a further displacement, places and axes kept."""
        return replace(self, missing=self.missing - self.of(step))


class Measurement(Protocol):
    """Anything that can be compared with a displacement.

    Attributes
    ----------
    kind : str
        "pairs", "landmarks", "surface" or "whole surface".
    labels : tuple of str
        The name of each place.
    points : (n, 3) array
        The places at rest, mm; of a surface, where it was measured.
    measured : (n, 3) array
        Where they were found after the shift, mm.
    distance_mm : float
        Median distance of the points from the body's surface at rest.
    sunk_mm : float
        How far the exposed part sank into the brain, in the median; infinite of a whole
        surface, which tells an offset by itself.
    """

    kind: str
    labels: tuple[str, ...]
    points: FloatArray
    measured: FloatArray
    distance_mm: float
    sunk_mm: float

    def observe(self, displacement: FloatArray) -> Observation:
        """Return what is measured about a displacement (n_points, 3), mm."""
        ...


def stacked(observations: Sequence[Observation]) -> Observation:
    """Return observations of as many components each as one."""
    return Observation(
        csr_array(vstack([one.places for one in observations])),
        np.concatenate([one.axes for one in observations]),
        np.concatenate([one.missing for one in observations]),
    )
