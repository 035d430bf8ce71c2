"""Learners of the time before networks on meshes: what a new one is compared with."""

from physgnn.prediction.classical.regressors import REGRESSORS, regressor_answer

__all__ = ["REGRESSORS", "regressor_answer"]
