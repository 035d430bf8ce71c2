"""The trained models that come with the package, made by ``physgnn bundle``."""

from pathlib import Path

BUNDLED_RUN = Path(__file__).with_name("mni152")
"""A run folder: the MNI152 brain with a tumour, pushed through a craniotomy."""
BUNDLED_FAMILY = Path(__file__).with_name("family")
"""A run folder for `physgnn adapt`: trained on synthetic patients."""
FAMILY_NAME = "bundled-family"
"""What the command line calls it."""
