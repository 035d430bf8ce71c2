"""The live view: a page to load the brain on, and the server that predicts for it."""

from physgnn.serving.server import serve

__all__ = ["serve"]
