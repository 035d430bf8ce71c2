"""The published figures our own stand beside.

Salehi & Giannacopoulos, "PhysGNN", NeurIPS 2022, test sets: dataset 1 with
configuration 9, dataset 2 with configuration 3 (PROTOCOL §8). Their split shares load
paths between training and test set.
"""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class PublishedErrors:
    """One row of the published tables, mm; each pair is mean and standard deviation."""

    x: tuple[float, float]
    y: tuple[float, float]
    z: tuple[float, float]
    euclidean: tuple[float, float]
    position: tuple[float, float]
    within_1mm: float
    position_within_1mm: float
    medians: tuple[float, float, float, float, float]
    largest_displacement: float
    largest_displacement_per_sample: tuple[float, float]
    largest_error_per_sample: tuple[float, float]
    seconds: float


PUBLISHED: Mapping[str, PublishedErrors] = {
    "paper-1": PublishedErrors(
        x=(0.1117, 0.2750),
        y=(0.0999, 0.2318),
        z=(0.0999, 0.2601),
        euclidean=(0.2049, 0.4329),
        position=(0.1612, 0.3961),
        within_1mm=0.9511,
        position_within_1mm=0.9618,
        medians=(0.0200, 0.0227, 0.0224, 0.0537, 0.0303),
        largest_displacement=24.59,
        largest_displacement_per_sample=(11.62, 5.77),
        largest_error_per_sample=(2.59, 1.57),
        seconds=1.8294,
    ),
    "paper-2": PublishedErrors(
        x=(0.1393, 0.3402),
        y=(0.1842, 0.5479),
        z=(0.1249, 0.2272),
        euclidean=(0.3023, 0.6671),
        position=(0.2023, 0.5920),
        within_1mm=0.9460,
        position_within_1mm=0.9659,
        medians=(0.0426, 0.0534, 0.0529, 0.1285, 0.0646),
        largest_displacement=47.82,
        largest_displacement_per_sample=(16.42, 10.47),
        largest_error_per_sample=(4.20, 2.52),
        seconds=1.8294,
    ),
}
