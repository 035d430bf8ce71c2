"""Datasets: load paths on a mesh, their solutions on disk, and their splits."""

from physgnn.dataset.generate import Generation, generate
from physgnn.dataset.presets import PRESETS, Preset
from physgnn.dataset.split import (
    SPLITS,
    Split,
    split_node,
    split_path,
    split_published,
)
from physgnn.dataset.store import Store

__all__ = [
    "PRESETS",
    "SPLITS",
    "Generation",
    "Preset",
    "Split",
    "Store",
    "generate",
    "split_node",
    "split_path",
    "split_published",
]
