"""The names that `physgnn.evaluation` exports, and where each is."""

from .measure.baselines import baseline_names as baseline_names
from .measure.baselines import baseline_rows as baseline_rows
from .measure.held_out import HeldOut as HeldOut
from .measure.measuring import evaluate as evaluate
from .measure.result import ModelErrors as ModelErrors
from .measure.result import Report as Report
from .measure.rows import Row as Row
from .run_evaluation import Comparison as Comparison
from .run_evaluation import evaluate_run as evaluate_run
from .run_evaluation import evaluate_runs as evaluate_runs
from .run_evaluation import write_evaluation as write_evaluation

__all__: list[str]
