"""What stands above everything else if a model is not worth its training."""

from physgnn.evaluation.measure.against_linear import LINEAR, beats_linear, mean_error
from physgnn.evaluation.measure.result import Report
from physgnn.evaluation.report.formats import mm
from physgnn.evaluation.report.style import label
from physgnn.evaluation.report.tables import group_label

INSTEAD = {
    "physgnn": "train model lifted instead",
    "lifted": "train longer, or on more load paths",
}


def linear_warning(report: Report) -> str:
    """Return the line that says a model loses to the linear solution; else nothing."""
    if beats_linear(report) is not False:
        return ""
    tested = report.groups[-1]
    linear = next(s for s in report.groups if s[0].name == LINEAR)
    advice = INSTEAD.get(tested[0].name, "take another model")
    return (
        f"{group_label(tested)} loses to the linear solution, which takes no training: "
        f"its mean error is {mm(mean_error(tested))} mm, the {label(LINEAR).lower()}'s "
        f"{mm(mean_error(linear))} mm. Do not use this model: {advice}."
    )
