"""The tables of the publication, with its own figures in their last row."""

from collections.abc import Callable, Sequence

import numpy as np

from physgnn.evaluation.formats import mm, percent, spread
from physgnn.evaluation.metrics import COMPONENTS
from physgnn.evaluation.published import PUBLISHED
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.evaluation.tables import Table, group_label

PUBLISHED_ROW = "Published test set"
Seeds = Sequence[ModelErrors]


def protocol_table(report: Report, preset: str = "") -> Table:
    """Return the means and shares of the publication."""
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
        "brain and on the split that shares load paths between training and test set.",
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
