"""A folder with all that the command line takes from mesh to prediction, small."""

from pathlib import Path

import pytest

from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh

LOADS = """
[materials.brain]
youngs_modulus_pa = 3000
poissons_ratio = 0.4
[materials.tumour]
youngs_modulus_pa = 7500
poissons_ratio = 0.4
[loads]
total_force_n = 0.02
paths = 10
levels = 2
nodes_per_path = 3
"""
TRAINING = "model = 'physgnn'\nmax_epochs = 2\nbatch_size = 4\n[options]\nwidth = 8\n"


@pytest.fixture
def folder(tmp_path: Path, block: TetMesh) -> Path:
    """A folder with case.vtu, loads.toml and training.toml."""
    write_mesh(tmp_path / "case.vtu", block)
    (tmp_path / "loads.toml").write_text(LOADS)
    (tmp_path / "training.toml").write_text(TRAINING)
    return tmp_path
