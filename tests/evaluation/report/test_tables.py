"""Numbers as people read them, and the published ones beside ours."""

from dataclasses import replace

import numpy as np
import pytest

from physgnn.evaluation.measure.result import Report
from physgnn.evaluation.report.formats import (
    duration,
    minutes,
    mm,
    percent,
    with_spread,
)
from physgnn.evaluation.report.page import report_html
from physgnn.evaluation.report.published import extremes_table, protocol_table
from physgnn.evaluation.report.tables import (
    accuracy_table,
    gentle_table,
    level_table,
    tolerance_table,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (0.00001, "< 0.0001"),
        (0.00036, "0.0004"),
        (0.01234, "0.0123"),
        (0.5, "0.500"),
        (1.234, "1.23"),
        (12.34, "12.3"),
        (123.4, "123"),
    ],
)
def test_millimetres(value: float, text: str) -> None:
    assert mm(value) == text


def test_per_cent_never_rounds_up_to_all() -> None:
    assert percent(1.0) == "100.0 %"
    assert percent(0.9994) == "99.94 %"
    assert percent(0.946) == "94.6 %"


def test_durations() -> None:
    assert (duration(0.0123), duration(12.34)) == ("12.3 ms", "12.3 s")
    assert (minutes(0.0), minutes(2.51), minutes(44)) == ("—", "2.5 min", "44 min")


def test_a_spread_has_the_decimals_of_its_mean() -> None:
    assert with_spread("0.750", 0.0099) == "0.750 ± 0.010"
    assert with_spread("77.6 %", 0.0021) == "77.6 ± 0.2 %"
    assert with_spread("134", 12.3) == "134 ± 12"
    assert with_spread("< 0.0001", 0.1) == "< 0.0001"


def test_every_row_is_as_wide_as_its_header(report: Report) -> None:
    for table in (
        accuracy_table(report),
        level_table(report),
        protocol_table(report, "paper-2"),
        extremes_table(report, "paper-1"),
    ):
        assert all(len(row) == len(table.columns) for row in table.rows)
        widths = {len(line) for line in table.text().splitlines()[2:]}
        assert len(widths) == 1


def test_published_figures_stand_beside_ours(report: Report) -> None:
    last = protocol_table(report, "paper-2").rows[-1]
    assert last[0] == "Published test set"
    assert last[4].startswith("0.302 ±")
    assert protocol_table(report, "demo").rows[-1][0] != "Published test set"


def test_accuracy_holds_the_numbers_of_the_report(report: Report) -> None:
    rows = {row[0]: row for row in accuracy_table(report).rows}
    mean = report.model("linear").euclidean.mean
    assert float(rows["Linear solution"][1]) == pytest.approx(mean, rel=0.01)
    assert rows["Zero displacement"][8] == "100.0 %"


def test_level_table_shows_first_and_last_level(report: Report) -> None:
    table = level_table(report)
    assert table.columns[-1] == "100 % load"
    assert table.columns[1] == "17 % load"
    zero = [float(cell) for cell in table.rows[0][1:]]
    assert (np.diff(zero) > 0).all()


def reseeded(report: Report, errors: list[float]) -> Report:
    """The linear row, once a seed, with these mean errors."""
    linear = report.model("linear")
    seeds = [
        replace(
            linear,
            seed=seed,
            by_component={
                **linear.by_component,
                "euclidean": replace(linear.euclidean, mean=mean),
            },
        )
        for seed, mean in enumerate(errors)
    ]
    return replace(report, models=(report.models[0], *seeds))


def test_seeds_are_one_row_of_mean_and_spread(report: Report) -> None:
    table = accuracy_table(reseeded(report, [0.1, 0.2, 0.6]))
    assert len(table.rows) == 2
    assert table.rows[1][1] == "0.300 ± 0.265"
    assert "over training seeds (up to 3)" in table.note
    assert "±" not in accuracy_table(report).note


def test_a_tolerance_has_a_table_of_its_own(report: Report) -> None:
    assert tolerance_table(report) is None
    linear = report.model("linear")
    largest = sorted(sample.largest for sample in linear.samples)
    kept = replace(linear, name="certified", tolerance_mm=largest[len(largest) // 2])
    table = tolerance_table(replace(report, models=(kept,)))
    assert table is not None
    (row,) = table.rows
    share = np.mean(np.array(largest) <= kept.tolerance_mm)
    assert row[2] == percent(float(share))
    assert row[-1] == f"{len(largest)} no error estimate"


def test_gentle_loads_have_a_table_of_their_own(report: Report) -> None:
    assert gentle_table(report) is None  # of an evaluation that did not look for them
    linear = report.model("linear")
    first, *_ = linear.samples
    record = {"samples": [[first.path, first.level]], "n_samples": 9, "gentlest_n": 0.1}
    table = gentle_table(report.with_facts(gentle_loads=record))
    assert table is not None
    rows = {row[0]: row for row in table.rows}
    assert float(rows["Linear solution"][1]) == pytest.approx(first.mean, rel=0.01)
    assert "1 of 9 samples" in table.note
    none = {"samples": [], "n_samples": 9, "gentlest_n": 0.67}
    gentle = report.with_facts(gentle_loads=none)
    assert gentle_table(gentle) is None
    assert "the gentlest here has 0.67 N" in report_html(gentle, ())
