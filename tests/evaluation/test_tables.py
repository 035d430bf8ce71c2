"""Numbers as people read them, and the published ones beside ours."""

import numpy as np
import pytest

from physgnn.dataset.store import Store
from physgnn.evaluation.baselines import baselines
from physgnn.evaluation.evaluate import evaluate
from physgnn.evaluation.result import Report
from physgnn.evaluation.tables import (
    accuracy_table,
    duration,
    extremes_table,
    level_table,
    mm,
    percent,
    protocol_table,
)


@pytest.fixture(scope="module")
def report(store: Store) -> Report:
    samples = store.samples()
    return evaluate(baselines(store, samples, samples), store, samples, split="path")


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
