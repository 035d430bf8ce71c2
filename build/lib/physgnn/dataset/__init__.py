"""Datasets: load paths on a mesh, their solutions on disk, and their splits."""

from physgnn.dataset.generation.pending_paths import SOLVERS, Generation, generate
from physgnn.dataset.generation.verification import (
    Verification,
    verification_of,
    verify,
)
from physgnn.dataset.presets import PRESETS, Preset
from physgnn.dataset.splits.samples import (
    SPLITS,
    Split,
    named_split,
    split_node,
    split_path,
    split_published,
)
from physgnn.dataset.storage.store import Store

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
