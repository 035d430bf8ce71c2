"""Surfaces, tetrahedral meshes, point sets: everything before mechanics."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
