"""Predictors: a load case in, a displacement with its error estimate out."""

from physgnn.prediction.error_bounds.run_calibration import calibrate_run
from physgnn.prediction.finite_element import FiniteElementPredictor
from physgnn.prediction.prediction import (
    ErrorBound,
    Predict,
    Prediction,
)
from physgnn.prediction.predictor import Predictor
from physgnn.prediction.status import PredictionStatus

__all__ = [
    "ErrorBound",
    "FiniteElementPredictor",
    "Predict",
    "Prediction",
    "PredictionStatus",
    "Predictor",
    "calibrate_run",
]
