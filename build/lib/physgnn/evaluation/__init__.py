"""Errors of predictors on held-out samples: tables, figures and a report."""

from physgnn.evaluation.measure.baselines import baseline_names, baseline_rows
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.measuring import evaluate
from physgnn.evaluation.measure.result import ModelErrors, Report
from physgnn.evaluation.measure.rows import Row
from physgnn.evaluation.run_evaluation import (
    Comparison,
    evaluate_run,
    evaluate_runs,
    write_evaluation,
)

__all__ = [
    "Comparison",
    "HeldOut",
    "ModelErrors",
    "Report",
    "Row",
    "baseline_names",
    "baseline_rows",
    "evaluate",
    "evaluate_run",
    "evaluate_runs",
    "write_evaluation",
]
