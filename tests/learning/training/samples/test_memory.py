import weakref
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from torch import Tensor

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.graph import graph_of
from physgnn.learning.models import build_model
from physgnn.learning.physgnn.model import PhysGNNModel
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training import training_run as training
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.samples.memory import (
    PEAK,
    kept_bytes,
    measure,
    samples_at_once,
)
from physgnn.learning.training.training_run import train


@pytest.fixture
def model(store: Store) -> PhysGNNModel:
    torch.manual_seed(0)
    return build_model("physgnn", store.body, width=16)


def inputs(model: PhysGNNModel, store: Store, n: int) -> Tensor:
    """Samples of one path: which rows a batch computes depends on the loaded points."""
    return torch.stack([model.encode(store.load_case(0, i % 4)) for i in range(n)])


def test_counts_what_a_product_keeps() -> None:
    weight = torch.nn.Parameter(torch.ones(5, 5))
    x = torch.ones(7, 5)
    assert kept_bytes(lambda: (x @ weight).relu()) == 2 * x.numel() * 4


def test_counting_keeps_nothing() -> None:
    weight, seen = torch.nn.Parameter(torch.ones(5, 5)), []

    def forward() -> Tensor:
        y = (torch.ones(7, 5) @ weight).relu()  # whose way back needs the result
        seen.append(weakref.ref(y))
        return y

    kept_bytes(forward)
    assert seen[0]() is None


def test_memory_grows_with_the_batch_in_a_straight_line(
    model: PhysGNNModel, store: Store
) -> None:
    def forward(n: int) -> Tensor:
        return model(inputs(model, store, n), graph_of(model.body))

    memory = measure(forward)
    five = kept_bytes(lambda: forward(5))
    assert five == pytest.approx(memory.fixed + 5 * memory.a_sample, rel=0.2)


def test_sparing_memory_changes_no_gradient(model: PhysGNNModel, store: Store) -> None:
    x, graph = inputs(model, store, 3), graph_of(model.body)
    model.eval()
    gradients, kept = [], []
    for spare in (False, True):
        model.spare_memory(spare)
        kept.append(kept_bytes(lambda: model(x, graph)))
        model.zero_grad()
        model(x, graph).square().mean().backward()
        gradients.append([p.grad.clone() for p in model.parameters()])
    assert kept[1] < 0.5 * kept[0]
    for plain, spared in zip(*gradients, strict=True):
        torch.testing.assert_close(plain, spared)


def test_takes_the_batch_that_fits_or_says_what_it_needs(model: PhysGNNModel) -> None:
    megabyte = torch.ones(2**18)
    weight = torch.nn.Parameter(torch.ones(1))

    def forward(n: int) -> Tensor:
        return torch.stack([(megabyte + i) * weight for i in range(n)])

    for limit, expected in ((8.5, 8), (4.5, 4), (7.5, 4), (3.5, 3), (1.5, 1)):
        found = samples_at_once(model, forward, batch_size=8, limit_mb=PEAK * limit)
        assert found == expected, limit
    with pytest.raises(InputError, match="needs 2 MB for one sample, memory_mb is 0"):
        samples_at_once(model, forward, batch_size=8, limit_mb=0.4)


def test_training_in_parts_gives_the_same_weights(
    store: Store, split: Split, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = TrainingConfig(
        options={"width": 8}, batch_size=6, max_epochs=3, learning_rate=1e-3, seed=3
    )
    train(store, split, config, tmp_path / "whole")
    monkeypatch.setattr(training, "samples_at_once", lambda *_, **__: 4)
    train(store, split, replace(config, memory_mb=1.0), tmp_path / "parts")
    expected = Checkpoint.load(tmp_path / "whole").model.state_dict()
    for name, value in Checkpoint.load(tmp_path / "parts").model.state_dict().items():
        torch.testing.assert_close(value, expected[name], rtol=1e-3, atol=1e-5)
