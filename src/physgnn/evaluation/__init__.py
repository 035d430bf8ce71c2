"""Errors of predictors on held-out samples: tables, figures and a report."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
