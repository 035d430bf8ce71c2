"""Datasets: load paths on a mesh, their solutions on disk, and their splits."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
