"""Hyperelastic finite elements: materials, loads, equilibrium along a load path."""

from physgnn.lazy import attach
from physgnn.mechanics.kernel_cache import drop_stale_kernels as _drop_stale_kernels

__getattr__, __all__ = attach(__name__, __file__)

_drop_stale_kernels()  # before any is imported
