"""The trained model that comes with the package, made by ``physgnn bundle``."""

from pathlib import Path

BUNDLED_RUN = Path(__file__).with_name("mni152")
"""A run folder: the MNI152 brain with a tumour, pushed through a craniotomy."""
