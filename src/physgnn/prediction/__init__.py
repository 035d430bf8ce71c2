"""Predictors: a load case in, a displacement with its error estimate out."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
