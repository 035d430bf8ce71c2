from pathlib import Path

import pytest
import torch

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph, graph_of
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.physgnn.precision import set_precision
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train


@pytest.fixture
def network() -> PhysGNN:
    torch.manual_seed(0)
    return PhysGNN(width=16).eval()


def test_bfloat16_is_near_and_float32_comes_back(
    network: PhysGNN, block: TetMesh
) -> None:
    graph, x = Graph.from_mesh(block), torch.zeros(2, block.n_points, 7)
    x[:, :5, 1:] = torch.randn(2, 5, 6)
    with torch.inference_mode():
        exact = network(x, graph)
        set_precision(network, "bfloat16")
        near = network(x, graph)
        set_precision(network, "float32")
        assert torch.equal(network(x, graph), exact)
    difference = (near - exact).norm(dim=-1).mean() / exact.norm(dim=-1).mean()
    assert 0 < difference < 0.01


def test_training_in_bfloat16_has_nearly_the_gradients_of_float32(
    network: PhysGNN, block: TetMesh
) -> None:
    graph, x = Graph.from_mesh(block), torch.zeros(4, block.n_points, 7)
    x[:, :5, 1:] = torch.randn(4, 5, 6)
    gradients = []
    for precision in ("float32", "bfloat16"):
        set_precision(network, precision)
        network.zero_grad()
        network(x, graph).square().mean().backward()
        gradients.append([p.grad.clone() for p in network.parameters()])
    exact, rough = (torch.cat([g.flatten() for g in each]) for each in gradients)
    assert rough.dtype == torch.float32
    assert 0 < (rough - exact).norm() / exact.norm() < 0.02


def test_a_network_trained_in_bfloat16_answers_alike_in_both(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = TrainingConfig(
        options={"width": 16}, batch_size=4, max_epochs=3, precision="bfloat16"
    )
    model = train(store, split, config, tmp_path / "run").model.eval()
    x = torch.stack([model.encode(store.load_case(5, k)) for k in range(4)])
    answers = []
    with torch.inference_mode():
        for precision in ("float32", "bfloat16"):
            set_precision(model, precision)
            answers.append(model(x, graph_of(model.body)))
    distance = (answers[1] - answers[0]).norm(dim=-1).mean()
    assert 0 < distance < 0.005


def test_refuses_a_network_it_would_not_change() -> None:
    set_precision(torch.nn.Linear(2, 2), "float32")
    with pytest.raises(InputError, match="this model has none"):
        set_precision(torch.nn.Linear(2, 2), "bfloat16")


def test_refuses_a_precision_there_is_not(network: PhysGNN) -> None:
    with pytest.raises(InputError, match="float32, bfloat16"):
        set_precision(network, "float8")
