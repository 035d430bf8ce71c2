"""Errors of predicted displacement fields: per node, per sample and pooled."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from physgnn.arrays import BoolArray, FloatArray, IntArray
from physgnn.evaluation.measure.distribution import Distribution, RunningDistribution
from physgnn.geometry.tetmesh import TetMesh

COMPONENTS = ("x", "y", "z", "euclidean", "position")
LOADED_REGION_MM = 10.0  # the loaded region: points this near a loaded point, at rest


@dataclass(frozen=True)
class SampleError:
    """Errors of one sample, mm (`relative`: ‖u − û‖ / ‖u‖ over all nodes).

    `loaded_region` and `tumour` are mean Euclidean errors there; the estimates are
    those the prediction carried, None without calibration.
    """

    path: int
    level: int
    load_factor: float
    mean: float
    largest: float
    relative: float
    mean_displacement: float
    largest_displacement: float
    loaded_region: float
    tumour: float | None
    estimate_mean: float | None
    estimate_largest: float | None
    status: str
    seconds: float


def nodal_errors(truth: FloatArray, predicted: FloatArray) -> dict[str, FloatArray]:
    """Return the absolute errors of every node, one (n_points,) array a component.

    x, y, z : |u_i − û_i|;  euclidean : |u − û|;  position : ||u| − |û|| (PROTOCOL's
    "absolute position error", which the paper leaves undefined).
    """
    difference = np.asarray(truth, dtype=np.float64) - predicted
    lengths = np.linalg.norm(truth, axis=1) - np.linalg.norm(predicted, axis=1)
    return {
        "x": np.abs(difference[:, 0]),
        "y": np.abs(difference[:, 1]),
        "z": np.abs(difference[:, 2]),
        "euclidean": np.linalg.norm(difference, axis=1),
        "position": np.abs(lengths),
    }


def points_near(
    mesh: TetMesh, nodes: IntArray, *, radius_mm: float = LOADED_REGION_MM
) -> BoolArray:
    """Return which points lie within `radius_mm` of one of `nodes`, at rest."""
    distance, _ = cKDTree(mesh.points[nodes]).query(mesh.points)
    return np.asarray(distance <= radius_mm)


def points_of_region(mesh: TetMesh, region: int) -> BoolArray:
    """Return which points belong to a cell of `region`."""
    inside = np.zeros(mesh.n_points, dtype=bool)
    inside[mesh.cells[mesh.region == region]] = True
    return inside


class PooledErrors:
    """Pools nodal errors over samples: by component, by region and by level."""

    def __init__(self, n_levels: int) -> None:
        self.components = {name: RunningDistribution() for name in COMPONENTS}
        self.regions = {
            name: RunningDistribution() for name in ("loaded_region", "tumour")
        }
        self.levels = [RunningDistribution() for _ in range(n_levels)]

    def add(
        self,
        errors: Mapping[str, FloatArray],
        level: int,
        regions: Mapping[str, BoolArray],
    ) -> None:
        """Take the `nodal_errors` of one sample at a 0-based level."""
        for name, values in errors.items():
            self.components[name].add(values)
        for name, inside in regions.items():
            self.regions[name].add(errors["euclidean"][inside])
        self.levels[level].add(errors["euclidean"])

    def by_component(self) -> dict[str, Distribution]:
        """Return the distribution of every component that has values."""
        return _summaries(self.components)

    def by_region(self) -> dict[str, Distribution]:
        """Return the distribution of the Euclidean error in every region met."""
        return _summaries(self.regions)

    def by_level(self) -> tuple[Distribution | None, ...]:
        """Return the distribution of the Euclidean error at every level."""
        return tuple(level.summary() for level in self.levels)


@dataclass(frozen=True)
class SampleSummary:
    """What PROTOCOL §8 reports over samples rather than over nodes, mm.

    `relative_mean` is the mean over samples of ‖u − û‖ / ‖u‖; `relative_pooled` the
    mean Euclidean error over the mean displacement.
    """

    n_samples: int
    relative_mean: float
    relative_std: float
    relative_pooled: float
    largest_displacement: float
    largest_displacement_mean: float
    largest_displacement_std: float
    largest_error_mean: float
    largest_error_std: float
    median_seconds: float


def summarise_samples(samples: Iterable[SampleError]) -> SampleSummary:
    """Return means, standard deviations and the median time over samples."""
    rows = list(samples)

    def column(name: str) -> FloatArray:
        return np.array([getattr(row, name) for row in rows], dtype=np.float64)

    relative = column("relative")
    displacement = column("largest_displacement")
    largest = column("largest")
    return SampleSummary(
        n_samples=len(rows),
        relative_mean=float(relative.mean()),
        relative_std=float(relative.std()),
        relative_pooled=float(
            column("mean").mean() / column("mean_displacement").mean()
        ),
        largest_displacement=float(displacement.max()),
        largest_displacement_mean=float(displacement.mean()),
        largest_displacement_std=float(displacement.std()),
        largest_error_mean=float(largest.mean()),
        largest_error_std=float(largest.std()),
        median_seconds=float(np.median(column("seconds"))),
    )


def _summaries(
    running: Mapping[str, RunningDistribution],
) -> dict[str, Distribution]:
    summaries = {name: values.summary() for name, values in running.items()}
    return {name: value for name, value in summaries.items() if value is not None}
