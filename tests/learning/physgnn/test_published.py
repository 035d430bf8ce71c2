from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph
from physgnn.learning.physgnn.published import load_published


@pytest.mark.parametrize(("configuration", "dataset"), [(9, 1), (3, 2)])
def test_published_weights_give_the_published_forward_pass(
    shared: Path, configuration: int, dataset: int
) -> None:
    golden = np.load(shared / "paper" / "golden_forward.npz")
    mesh = TetMesh(golden["points"], golden["cells"], golden["region"])
    weights = shared / "paper" / f"config{configuration}_dataset{dataset}.pt"
    network = load_published(weights, configuration=configuration, dataset=dataset)
    assert not network.training
    with torch.inference_mode():
        y = network(torch.from_numpy(golden[f"x_{dataset}"]), Graph.from_mesh(mesh))
    expected = golden[f"y_{dataset}_{configuration}"]
    assert np.linalg.norm(y.numpy() - expected, axis=1).max() < 1e-4  # mm


def test_refuses_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        load_published(tmp_path / "none.pt")


def test_refuses_what_is_no_state_dict(tmp_path: Path) -> None:
    file = tmp_path / "text.pt"
    file.write_text("solid brain")
    with pytest.raises(InputError, match="state dict"):
        load_published(file)


def test_refuses_another_networks_weights(tmp_path: Path) -> None:
    file = tmp_path / "other.pt"
    torch.save(torch.nn.Linear(2, 2).state_dict(), file)
    with pytest.raises(InputError, match="published PhysGNN"):
        load_published(file)
