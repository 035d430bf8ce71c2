"""The loads a model was trained on, in four numbers and a set of nodes."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from physgnn.arrays import FloatArray
from physgnn.errors import InputError
from physgnn.mechanics.loads.paths import LoadCase

SLACK = 0.01  # relative; the highest training level itself must count as inside


@dataclass(frozen=True)
class TrainedRange:
    """Bounds of the training loads.

    Every bound is the extreme of one number over the training loads, so one more load
    of the same kind exceeds it with a probability of about 1 / (n_paths + 1).

    Attributes
    ----------
    nodes : tuple of int
        Points that carried a force in training.
    fewest_nodes : int
        Smallest number of loaded points in a load case.
    total_force_n, nodal_force_n : float
        Largest sum of force magnitudes, and largest force on one point, N.
    axis : tuple of three floats
        Mean direction of the resultant force (zero if there is none).
    smallest_cosine : float
        Widest angle between a resultant and `axis`, as its cosine.
    """

    nodes: tuple[int, ...]
    fewest_nodes: int
    total_force_n: float
    nodal_force_n: float
    axis: tuple[float, float, float]
    smallest_cosine: float

    def __post_init__(self) -> None:
        """Refuse numbers that no load would ever lie outside of."""
        numbers = (self.total_force_n, self.nodal_force_n, self.smallest_cosine)
        if not np.isfinite((*numbers, *self.axis)).all():
            raise InputError(f"the trained range must be finite (got {numbers})")

    @classmethod
    def from_cases(cls, cases: Iterable[LoadCase]) -> "TrainedRange":
        """Return the range that just holds these load cases."""
        cases = list(cases)
        nodes = np.unique(np.concatenate([case.nodes for case in cases]))
        sizes = [np.linalg.norm(case.forces, axis=1) for case in cases]
        directions = np.array([_direction(case) for case in cases])
        axis = _unit(directions.mean(axis=0))
        return cls(
            nodes=tuple(nodes.tolist()),
            fewest_nodes=min(len(case.nodes) for case in cases),
            total_force_n=max(float(size.sum()) for size in sizes),
            nodal_force_n=max(float(size.max()) for size in sizes),
            axis=(float(axis[0]), float(axis[1]), float(axis[2])),
            smallest_cosine=float((directions @ axis).min()),
        )

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> "TrainedRange":
        """Return the range from what `dataclasses.asdict` and JSON made of it."""
        sequences = {key: tuple(record[key]) for key in ("nodes", "axis")}
        return cls(**{**record, **sequences})

    def reasons_outside(self, case: LoadCase) -> list[str]:
        """Return why a load case lies outside, one line each; empty if inside."""
        size = np.linalg.norm(case.forces, axis=1)
        new_nodes = np.setdiff1d(case.nodes, self.nodes)
        cosine = float(_direction(case) @ np.array(self.axis))
        reasons = (
            (
                len(new_nodes) > 0,
                f"{len(new_nodes)} loaded nodes never carried a force in training",
            ),
            (
                len(case.nodes) < self.fewest_nodes,
                f"{len(case.nodes)} loaded nodes (trained on {self.fewest_nodes} "
                "or more)",
            ),
            (
                size.sum() > self.total_force_n * (1 + SLACK),
                f"{size.sum():.3g} N in all (trained up to {self.total_force_n:.3g} N)",
            ),
            (
                size.max() > self.nodal_force_n * (1 + SLACK),
                f"{size.max():.3g} N on one node "
                f"(trained up to {self.nodal_force_n:.3g} N)",
            ),
            (
                cosine < self.smallest_cosine - SLACK,
                f"the resultant is {_degrees(cosine):.0f} degrees from the trained "
                f"axis (trained up to {_degrees(self.smallest_cosine):.0f})",
            ),
        )
        return [text for is_outside, text in reasons if is_outside]


def _direction(case: LoadCase) -> FloatArray:
    return _unit(case.forces.sum(axis=0))


def _unit(vector: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.zeros(3)


def _degrees(cosine: float) -> float:
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
