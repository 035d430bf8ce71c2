"""Errors at forces as gentle as most of those that surgeons use.

Gan et al., "Quantification of forces during a neurosurgical procedure: a pilot study",
World Neurosurgery 84 (2015), measured at instruments: seven forces in ten are at most
0.3 N. The published datasets go on to 1.35 and 20 N.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.result import ModelErrors

GENTLE_N = 0.3


@dataclass(frozen=True)
class GentleLoads:
    """Which samples of an evaluation have loads of at most `GENTLE_N` in all.

    Attributes
    ----------
    samples : frozenset of (path, level)
    n_samples : int
        All there are, gentle or not.
    gentlest_n : float
        The smallest force in all of any sample, N.
    """

    samples: frozenset[tuple[int, int]]
    n_samples: int
    gentlest_n: float

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "GentleLoads":
        """Return what `to_json` and JSON made of it."""
        samples = frozenset((path, level) for path, level in record["samples"])
        return cls(samples, record["n_samples"], record["gentlest_n"])

    def to_json(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return {
            "samples": sorted(map(list, self.samples)),
            "n_samples": self.n_samples,
            "gentlest_n": self.gentlest_n,
        }


def find_gentle_loads(store: Store, samples: IntArray) -> GentleLoads:
    """Return the gentle ones of samples, rows of (path, level), by a dataset's loads.

    A load's force in all is the sum of the magnitudes of its nodal forces.
    """
    total = {
        path: float(np.linalg.norm(store.load_path(path).forces, axis=1).sum())
        for path in np.unique(samples[:, 0]).tolist()
    }
    forces = {
        (path, level): total[path] * float(store.load_factors[level])
        for path, level in samples.tolist()
    }
    gentle = (key for key, force in forces.items() if force <= GENTLE_N)
    return GentleLoads(frozenset(gentle), len(forces), min(forces.values()))


def mean_over(loads: GentleLoads, figure: str) -> Callable[[ModelErrors], float | None]:
    """Return what gives a model's mean of a field of a sample at gentle loads."""

    def mean(model: ModelErrors) -> float | None:
        gentle = [s for s in model.samples if (s.path, s.level) in loads.samples]
        found = [getattr(sample, figure) for sample in gentle]
        numbers = [number for number in found if number is not None]
        return float(np.mean(numbers)) if numbers else None

    return mean
