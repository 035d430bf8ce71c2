"""Two processes that train together do what one does."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.learning.checkpoint import Checkpoint
from physgnn.learning.training import train
from physgnn.learning.training_config import TrainingConfig

PROGRAM = """
import sys, torch
from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.learning.trainer import Machine
from physgnn.learning.training import train
from physgnn.learning.training_config import TrainingConfig

torch.set_num_threads(1)
store = Store.open(sys.argv[1])
samples = store.samples()
path = samples[:, 0]
split = Split("path", samples[path < 4], samples[path == 4], samples[path == 5])
config = TrainingConfig(**{config})
train(store, split, config, sys.argv[2], machine=Machine(devices=2))
"""
# 16 samples in batches of 7: shares are unequal, and the last batch is smaller
CONFIG = {
    "options": {"width": 8},
    "batch_size": 7,
    "max_epochs": 4,
    "plateau_patience": 0,
    "learning_rate": 1e-3,
    "seed": 3,
}


def metrics(run: Path) -> list[dict[str, str]]:
    with (run / "metrics.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_two_processes_have_the_loss_curve_of_one(
    store: Store, split: Split, tmp_path: Path
) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.replace("{config}", repr(CONFIG)))
    one, two = tmp_path / "one", tmp_path / "two"
    train(store, split, TrainingConfig(**CONFIG), one)
    done = subprocess.run(
        [sys.executable, program, store.path, two],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert len(metrics(one)) == 4
    for of_one, of_two in zip(metrics(one), metrics(two), strict=True):
        assert of_one["learning_rate"] == of_two["learning_rate"]
        for name in ("training_loss", "validation_loss"):
            assert float(of_two[name]) == pytest.approx(float(of_one[name]), rel=1e-4)
    expected = Checkpoint.load(one).model.state_dict()
    for name, value in Checkpoint.load(two).model.state_dict().items():
        if name.endswith("score.bias"):
            continue  # softmax cancels it: its gradient is rounding, which AdamW scales
        torch.testing.assert_close(value, expected[name], rtol=1e-3, atol=1e-5)
