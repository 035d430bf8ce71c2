"""The same outputs as NVIDIA PhysicsNeMo's networks with the same weights.

``physicsnemo_outputs.npz`` was written once by nvidia-physicsnemo 2.2.2: random
weights (by the names they have here), inputs and outputs of its ``MeshGraphNet`` (two
steps, width 8, sums) and ``Transolver`` (two layers, two heads, four slices,
``mlp_ratio`` 1, ``use_te`` off) on a random graph of twelve points.
"""

from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.learning.graph import Graph
from physgnn.learning.mesh_networks import transolver
from physgnn.learning.mesh_networks.meshgraphnet import MeshGraphNet
from physgnn.learning.mesh_networks.transolver import Transolver

THEIR_EMPTY = 1e-2  # added to a slice's weights; the paper's code adds 1e-5


@pytest.fixture(scope="module")
def stored() -> dict[str, torch.Tensor]:
    file = np.load(Path(__file__).with_name("physicsnemo_outputs.npz"))
    return {name: torch.from_numpy(file[name]) for name in file.files}


def restored(
    network: torch.nn.Module, name: str, stored: dict[str, torch.Tensor]
) -> torch.nn.Module:
    start = f"{name}.weights."
    weights = {k.removeprefix(start): v for k, v in stored.items() if start in k}
    network.load_state_dict(weights)
    return network.eval()


def test_meshgraphnet(stored: dict[str, torch.Tensor]) -> None:
    start, column = stored["graph.row_start"], stored["graph.column"]
    graph = Graph(start, column, torch.ones(len(column)), len(start) - 1)
    network = restored(MeshGraphNet(5, 3, width=8, steps=2), "meshgraphnet", stored)
    found = network(
        stored["meshgraphnet.inputs"][None], stored["meshgraphnet.edge_inputs"], graph
    )
    torch.testing.assert_close(
        found[0], stored["meshgraphnet.outputs"], atol=2e-6, rtol=1e-5
    )


def test_transolver(
    stored: dict[str, torch.Tensor], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(transolver, "EMPTY", THEIR_EMPTY)
    network = restored(
        Transolver(9, 3, width=8, layers=2, heads=2, slices=4), "transolver", stored
    )
    found = network(stored["transolver.inputs"])
    torch.testing.assert_close(
        found, stored["transolver.outputs"], atol=2e-6, rtol=1e-5
    )
