"""A network that learnt next to nothing is not called ok by the commands."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from physgnn.geometry.tetmesh import TetMesh


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
def test_one_epoch_and_ten_times_the_load(folder: Path, block: TetMesh) -> None:
    """It said 2,363 mm, and ok."""
    training = folder / "training.toml"
    training.write_text(
        training.read_text().replace("max_epochs = 2", "max_epochs = 1")
    )
    for command in (
        "simulate case.vtu --loads loads.toml -o loads.zarr",
        "train loads.zarr --config training.toml -o run",
    ):
        code, said = physgnn(folder, *command.split())
        assert code == 0, said
    top = block.points[block.point_set("loaded")[:3]]
    load = {"points": top.tolist(), "forces_n": np.tile([0, 0, -0.07], (3, 1)).tolist()}
    (folder / "load.json").write_text(json.dumps(load))
    for estimate in ("quick", "physical"):
        out = f"{estimate}.vtu"
        given = f"run --load load.json -o {out} --estimate {estimate}"
        code, said = physgnn(folder, "predict", *given.split())
        assert code == 3, said
        assert "ok:" not in said
        assert (folder / out).is_file()
