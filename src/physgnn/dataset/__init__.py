"""Datasets: load paths on a mesh, their solutions on disk, and their splits."""

from physgnn.dataset.store import Store

__all__ = ["Store"]
