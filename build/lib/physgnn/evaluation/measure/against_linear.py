"""Whether a model beats the linear solution, which takes no training."""

from collections.abc import Sequence

import numpy as np

from physgnn.evaluation.measure.result import ModelErrors, Report

LINEAR = "linear"


def beats_linear(report: Report) -> bool | None:
    """Return whether the model under test has a smaller mean error than K₀⁻¹ f.

    Returns
    -------
    bool or None
        None if the linear solution was not measured beside it, or is what is tested.
        Of several seeds the mean counts.
    """
    tested = report.groups[-1]
    linear = [seeds for seeds in report.groups[:-1] if seeds[0].name == LINEAR]
    if not linear:
        return None
    return mean_error(tested) < mean_error(linear[0])


def mean_error(seeds: Sequence[ModelErrors]) -> float:
    """Return the mean Euclidean error over nodes, samples and seeds, mm."""
    return float(np.mean([model.euclidean.mean for model in seeds]))
