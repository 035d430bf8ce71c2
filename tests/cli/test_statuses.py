"""A network that learnt next to nothing is not called ok by the commands."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
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
CONFIG = """
model = "physgnn"
max_epochs = 1
batch_size = 4
[options]
width = 8
"""


def physgnn(folder: Path, *words: object) -> tuple[int, str]:
    program = "from physgnn.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", program, *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_one_epoch_and_ten_times_the_load(tmp_path: Path, block: TetMesh) -> None:
    """It said 2,363 mm, and ok."""
    write_mesh(tmp_path / "block.vtu", block)
    (tmp_path / "loads.toml").write_text(LOADS)
    (tmp_path / "train.toml").write_text(CONFIG)
    for command in (
        "simulate block.vtu --loads loads.toml -o loads.zarr",
        "train loads.zarr --config train.toml -o run",
    ):
        code, said = physgnn(tmp_path, *command.split())
        assert code == 0, said
    top = block.points[block.point_set("loaded")[:3]]
    load = {"points": top.tolist(), "forces_n": np.tile([0, 0, -0.07], (3, 1)).tolist()}
    (tmp_path / "load.json").write_text(json.dumps(load))
    for estimate in ("quick", "physical"):
        out = f"{estimate}.vtu"
        given = f"run --load load.json -o {out} --estimate {estimate}"
        code, said = physgnn(tmp_path, "predict", *given.split())
        assert code == 3, said
        assert "ok:" not in said
        assert (tmp_path / out).is_file()
