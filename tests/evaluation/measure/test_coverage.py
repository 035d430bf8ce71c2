"""Estimates and bounds are judged by what was true."""

import json
from pathlib import Path

import pytest
from matplotlib import pyplot

from physgnn.evaluation.measure.coverage import (
    BarSample,
    Bound,
    bar_facts,
    bound_kinds,
    bound_pairs,
    write_bars,
)
from physgnn.evaluation.report.plots.coverage_chart import bars_chart


def sample(level: int, *, likely: float, bound: float) -> BarSample:
    """A sample of mean error 1 mm and largest error 4 mm."""
    bounds = tuple(
        Bound("relaxation", promised, factor * bound, factor * 4 * bound)
        for promised, factor in ((0.9, 1.0), (0.95, 1.5))
    )
    return BarSample(0, level, (level + 1) / 10, 1.0, 4.0, likely, 4 * likely, bounds)


@pytest.fixture
def samples() -> list[BarSample]:
    """Ten levels; the estimate is three times too small at the two highest."""
    return [
        sample(level, likely=1.2 if level < 8 else 1 / 3, bound=2.0 if level else 0.7)
        for level in range(10)
    ]


def test_shares_are_counted_below_and_above_half_the_load(samples) -> None:
    facts = bar_facts(samples)
    low, high = (
        facts[f"physical estimate, up to {t}"] for t in ("half the load", "all of it")
    )
    assert "in 100.0 %, for the largest in 100.0 % of 5" in low
    assert "in 60.0 %" in high
    assert "too small by more in 40.0 % and 40.0 %" in high


def test_a_bound_held_where_it_was_not_below_the_error(samples) -> None:
    facts = bar_facts(samples)
    assert "mean error held in 90.0 %" in facts["bound at 90%, by relaxation"]
    assert "mean error held in 100.0 %" in facts["bound at 95%, by relaxation"]
    assert "over error 2 and 2" in facts["bound at 90%, by relaxation"]


def test_bounds_are_found_by_what_they_promise(samples) -> None:
    assert bound_kinds(samples) == [("relaxation", 0.9), ("relaxation", 0.95)]
    pairs = bound_pairs(samples[1:2], "relaxation", 0.95)
    assert pairs.tolist() == [[[1.0, 4.0], [3.0, 12.0]]]


def test_without_calibration_there_is_still_an_estimate() -> None:
    bare = [BarSample(0, 0, 1.0, 1.0, 2.0, 1.0, 2.0, ())]
    assert list(bar_facts(bare)) == ["physical estimate, up to all of it"]
    pyplot.close(bars_chart(bare))


def test_every_sample_is_written(samples, tmp_path: Path) -> None:
    write_bars(samples, tmp_path / "bars.json")
    record = json.loads((tmp_path / "bars.json").read_text())
    assert [row["level"] for row in record] == list(range(10))
    assert record[0]["bounds"][0]["indicator"] == "relaxation"


def test_the_chart_says_how_often_bounds_held(samples) -> None:
    figure = bars_chart(samples)
    held = figure.axes[2].lines[-2].get_ydata()
    assert min(held) < 60.0, "the lowest bin has the sample whose bound was too small"
    assert max(held) == 100.0
