"""Errors of predictors on held-out samples: tables, figures and a report."""

from physgnn.evaluation.baselines import baseline_names, baseline_rows
from physgnn.evaluation.evaluate import evaluate
from physgnn.evaluation.held_out import HeldOut
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.evaluation.rows import Row
from physgnn.evaluation.run import (
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
