"""Hyperelastic materials: one short file a law, one table of all."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
