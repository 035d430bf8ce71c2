"""The published figures, and the tables that show our own beside them.

Salehi & Giannacopoulos, "PhysGNN", NeurIPS 2022, test sets: dataset 1 with
configuration 9, dataset 2 with configuration 3 (PROTOCOL §8). Their split has load
paths between training and test set.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from physgnn.evaluation.measure.metrics import COMPONENTS
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report.formats import mm, percent, spread
from physgnn.evaluation.report.tables import Table, group_label

PUBLISHED_ROW = "Published test set"
Seeds = Sequence[ModelErrors]


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


def protocol_table(report: Report, preset: str = "") -> Table:
    """Return the means and percentages of the publication."""
    rows = [_protocol_row(seeds) for seeds in report.groups]
    if preset in PUBLISHED:
        published = PUBLISHED[preset]
        errors = [spread(*getattr(published, name)) for name in COMPONENTS]
        errors.insert(4, percent(published.within_1mm))
        position = percent(published.position_within_1mm)
        rows.append((PUBLISHED_ROW, *errors, position))
    return Table(
        "Errors as published, mm",
        (
            "",
            "MAE x",
            "MAE y",
            "MAE z",
            "mean Euclidean",
            "≤ 1 mm",
            "mean abs. position",
            "≤ 1 mm",
        ),
        tuple(rows),
        "± is the standard deviation over nodes and samples; several seeds are "
        "averaged. Absolute position error: difference of the displacements' "
        "magnitudes. The published figures were measured on another mesh of the same "
        "brain and on the split with load paths in both training and test set.",
    )


def _protocol_row(seeds: Seeds) -> tuple[str, ...]:
    cells = [
        spread(*(_mean(seeds, _component(name, part)) for part in ("mean", "std")))
        for name in COMPONENTS
    ]
    cells.insert(4, percent(_mean(seeds, lambda m: m.euclidean.within_1mm)))
    position = _mean(seeds, lambda m: m.by_component["position"].within_1mm)
    return (group_label(seeds), *cells, percent(position))


def extremes_table(report: Report, preset: str = "") -> Table:
    """Return the medians and the largest errors of the publication."""
    rows = [_extremes_row(seeds) for seeds in report.groups]
    if preset in PUBLISHED:
        published = PUBLISHED[preset]
        rows.append(
            (
                PUBLISHED_ROW,
                *(mm(median) for median in published.medians),
                mm(published.largest_displacement),
                spread(*published.largest_displacement_per_sample),
                spread(*published.largest_error_per_sample),
            )
        )
    return Table(
        "Medians and extremes as published, mm",
        (
            "",
            "median x",
            "median y",
            "median z",
            "median Euclidean",
            "median position",
            "largest displacement",
            "largest displacement, per sample",
            "largest error, per sample",
        ),
        tuple(rows),
        "Largest displacement is that of the true solution. Per sample: mean ± "
        "standard deviation over samples of the largest of a sample's nodes.",
    )


def _extremes_row(seeds: Seeds) -> tuple[str, ...]:
    true = seeds[0].summary
    return (
        group_label(seeds),
        *(mm(_mean(seeds, _component(name, "median"))) for name in COMPONENTS),
        mm(true.largest_displacement),
        spread(true.largest_displacement_mean, true.largest_displacement_std),
        spread(
            _mean(seeds, lambda m: m.summary.largest_error_mean),
            _mean(seeds, lambda m: m.summary.largest_error_std),
        ),
    )


def _mean(seeds: Seeds, value: Callable[[ModelErrors], float]) -> float:
    return float(np.mean([value(model) for model in seeds]))


def _component(name: str, part: str) -> Callable[[ModelErrors], float]:
    return lambda model: float(getattr(model.by_component[name], part))
