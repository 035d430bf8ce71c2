"""Errors of predictors on held-out samples: tables, figures and a report."""

from physgnn.evaluation.baselines import baselines
from physgnn.evaluation.evaluate import evaluate
from physgnn.evaluation.result import ModelErrors, Report
from physgnn.evaluation.run import evaluate_run, write_evaluation

__all__ = [
    "ModelErrors",
    "Report",
    "baselines",
    "evaluate",
    "evaluate_run",
    "write_evaluation",
]
