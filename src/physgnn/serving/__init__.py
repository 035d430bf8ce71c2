"""The live view: a page that pushes the brain, and a server that answers."""

from physgnn.serving.server import serve

__all__ = ["serve"]
