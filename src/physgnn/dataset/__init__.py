"""Datasets: load paths on a mesh, their solutions on disk, and their splits."""

from physgnn.dataset.generate import SOLVERS, Generation, generate
from physgnn.dataset.presets import PRESETS, Preset
from physgnn.dataset.split import (
    SPLITS,
    Split,
    named_split,
    split_node,
    split_path,
    split_published,
)
from physgnn.dataset.store import Store
from physgnn.dataset.verification import Verification, verification_of, verify

__all__ = [
    "PRESETS",
    "SOLVERS",
    "SPLITS",
    "Generation",
    "Preset",
    "Split",
    "Store",
    "Verification",
    "generate",
    "named_split",
    "split_node",
    "split_path",
    "split_published",
    "verification_of",
    "verify",
]
