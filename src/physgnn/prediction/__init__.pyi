"""The names that `physgnn.prediction` exports, and where each is."""

from .error_bounds.run_calibration import calibrate_run as calibrate_run
from .finite_element import FiniteElementPredictor as FiniteElementPredictor
from .prediction import ErrorBound as ErrorBound
from .prediction import Predict as Predict
from .prediction import Prediction as Prediction
from .predictor import Predictor as Predictor
from .status import PredictionStatus as PredictionStatus

__all__: list[str]
