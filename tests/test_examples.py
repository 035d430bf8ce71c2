"""What examples/ shows works."""

import runpy
from pathlib import Path

import pytest

from physgnn.config import read_preset, read_training
from physgnn.dataset import PRESETS

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_every_example_is_tested() -> None:
    names = {path.name for path in EXAMPLES.iterdir() if path.is_file()}
    assert names == {"craniotomy.toml", "training.toml", "simulate_block.py"}


def test_simulate_block(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example = runpy.run_path(str(EXAMPLES / "simulate_block.py"))
    example["main"](tmp_path / "block.zarr")
    printed = capsys.readouterr().out
    assert "30 samples, largest displacement" in printed
    assert "20 train, 5 test" in printed


def test_craniotomy_is_the_demonstration_in_toml() -> None:
    ours, demo = read_preset(EXAMPLES / "craniotomy.toml"), PRESETS["demo"]
    assert (ours.fixed, ours.loaded) == (demo.fixed, demo.loaded)
    assert ours.materials == demo.materials
    settings = {"nodes_per_path": None, "seed": 0}
    assert settings | ours.paths.keywords == settings | demo.paths.keywords


def test_training() -> None:
    config = read_training(EXAMPLES / "training.toml")
    assert config.options == {"configuration": 3, "dataset": 2}
    assert (config.batch_size, config.schedule) == (8, "plateau")
