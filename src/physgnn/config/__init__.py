"""Settings from TOML files: every key checked, every mistake one clear line."""

from physgnn.lazy import attach

__getattr__, __all__ = attach(__name__, __file__)
