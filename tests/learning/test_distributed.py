"""Two processes that train together, on one machine or two, do what one does."""

import csv
import os
import secrets
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import torch

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train

PROGRAM = """
import sys, torch
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.learning.training.devices import Machine
from physgnn.learning.training.training_run import train
from physgnn.learning.training.config import TrainingConfig

torch.set_num_threads(1)
store = Store.open(sys.argv[1])
samples = store.samples()
path = samples[:, 0]
split = Split("path", samples[path < 4], samples[path == 4], samples[path == 5])
config = TrainingConfig(**{config})
train(store, split, config, sys.argv[2], machine={machine})
"""
# 16 samples in batches of 7: shares are unequal, and the last batch is smaller
CONFIG: dict[str, Any] = {
    "options": {"width": 8},
    "batch_size": 7,
    "max_epochs": 4,
    "plateau_patience": 0,
    "learning_rate": 1e-3,
    "seed": 3,
}
LIFTED = {**CONFIG, "model": "lifted", "options": {"width": 8, "any_axes": True}}

Config = dict[str, Any]


def metrics(run: Path) -> list[dict[str, str]]:
    with (run / "metrics.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def launch(
    machine: str, config: Config, store: Store, out: Path, **variables: str
) -> subprocess.Popen:
    program = out.with_suffix(".py")
    text = PROGRAM.replace("{config}", repr(config)).replace("{machine}", machine)
    program.write_text(text)
    return subprocess.Popen(
        [sys.executable, program, store.path, out],
        env={**os.environ, "OMP_NUM_THREADS": "1", **variables},
        stderr=subprocess.PIPE,
        text=True,
    )


def on_one_machine(config: Config, store: Store, out: Path) -> list[subprocess.Popen]:
    return [launch("Machine(devices=2)", config, store, out)]


def on_two_machines(config: Config, store: Store, out: Path) -> list[subprocess.Popen]:
    address = {"MASTER_ADDR": "localhost", "MASTER_PORT": str(free_port())}
    return [
        launch(
            "Machine(num_nodes=2)", config, store, out, NODE_RANK=str(rank), **address
        )
        for rank in range(2)
    ]


def free_port() -> int:
    """Return a port below those that systems hand out, so that nobody gets it now."""
    while True:
        port = secrets.choice(range(20_000, 30_000))
        with socket.socket() as free, suppress(OSError):
            free.bind(("localhost", port))
            return port


@pytest.mark.parametrize(
    ("start", "config"),
    [
        (on_one_machine, CONFIG),
        (on_two_machines, CONFIG),
        (on_one_machine, LIFTED),  # validated before it trains
    ],
)
def test_two_processes_have_the_loss_curve_of_one(
    start: Callable[[Config, Store, Path], list[subprocess.Popen]],
    config: Config,
    store: Store,
    split: Split,
    tmp_path: Path,
) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    train(store, split, TrainingConfig(**config), one)
    for process in start(config, store, two):
        _, said = process.communicate(timeout=300)
        assert process.returncode == 0, said
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
