"""A model that loses to the linear solution is not shown as if it won."""

from dataclasses import replace

import pytest

from physgnn.evaluation.measure.against_linear import beats_linear
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.report.page import report_html
from physgnn.evaluation.report.verdict import linear_warning

GREEN = ('class="key wins"', '<tr class="tested">')


def named(report: Report, name: str, mean: float) -> ModelErrors:
    linear = report.model("linear")
    euclidean = replace(linear.euclidean, mean=mean)
    errors = {**linear.by_component, "euclidean": euclidean}
    return replace(linear, name=name, by_component=errors)


def beside_linear(report: Report, *means: float) -> Report:
    """PhysGNN, a seed for each mean error, after a linear solution with 0.5 mm."""
    tested = [
        replace(named(report, "physgnn", mean), seed=i) for i, mean in enumerate(means)
    ]
    return replace(report, models=(named(report, "linear", 0.5), *tested))


def test_a_loser_is_named_at_the_top_and_is_not_green(report: Report) -> None:
    lost = beside_linear(report, 0.4, 0.7)  # 0.55 mm on average
    assert beats_linear(lost) is False
    page = report_html(lost, ())
    warning = linear_warning(lost)
    assert "PhysGNN loses to the linear solution" in warning
    assert "0.550 mm" in warning
    assert "0.500 mm" in warning
    assert page.index('<p class="warning">') < page.index("Mean error")
    assert not any(mark in page for mark in GREEN)


def test_a_winner_is_green(report: Report) -> None:
    won = beside_linear(report, 0.4)
    assert beats_linear(won) is True
    page = report_html(won, ())
    assert linear_warning(won) == ""
    assert '<p class="warning">' not in page
    assert all(mark in page for mark in GREEN)


@pytest.mark.parametrize("names", [("zero", "physgnn"), ("zero", "linear")])
def test_nothing_is_said_without_the_linear_solution(
    report: Report, names: tuple[str, ...]
) -> None:
    alone = replace(report, models=tuple(named(report, name, 0.3) for name in names))
    assert beats_linear(alone) is None
    assert linear_warning(alone) == ""
    assert not any(mark in report_html(alone, ()) for mark in GREEN)
