"""Predictors: a load case in, a displacement with its error estimate out."""

from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.prediction import (
    ErrorEstimate,
    Predict,
    Prediction,
    PredictionStatus,
)
from physgnn.prediction.predictor import Predictor

__all__ = [
    "ErrorEstimate",
    "FiniteElementPredictor",
    "Predict",
    "Prediction",
    "PredictionStatus",
    "Predictor",
    "calibrate_run",
]
