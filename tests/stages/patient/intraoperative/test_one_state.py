"""What is said of a state that was registered."""

from physgnn.registration.misfits import Misfit
from physgnn.stages.patient.intraoperative.one_state import (
    OUTLIERS_NAMED,
    outlier_lines,
)


def test_the_farthest_outliers_are_named_and_the_rest_counted() -> None:
    bad = [Misfit("pairs", f"P{i}", 0, 0, 0, 30.0 - i, 0.01) for i in range(25)]
    few = list(outlier_lines(bad[:2]))
    assert few[0] == "outlier, pairs 'P0': 30.0 mm off, weight 0.01" and len(few) == 2
    lines = list(outlier_lines(bad))
    assert len(lines) == OUTLIERS_NAMED + 1 and lines[: len(few)] == few
    assert lines[-1] == "outliers, 5 more: --misfits FILE.csv lists all"
