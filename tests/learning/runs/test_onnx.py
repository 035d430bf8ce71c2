from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import Graph, graph_of
from physgnn.learning.models import build_model
from physgnn.learning.physgnn.architecture import CONFIGURATIONS, Architecture
from physgnn.learning.physgnn.network import PhysGNN
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.onnx import PlainPhysGNN, export_onnx


@pytest.mark.parametrize("configuration", CONFIGURATIONS)
@pytest.mark.parametrize("dataset", [1, 2])
def test_plain_operators_give_the_same(
    block: TetMesh, configuration: int, dataset: int
) -> None:
    torch.manual_seed(configuration)
    network = PhysGNN(Architecture(configuration, dataset), width=16).eval()
    graph = Graph.from_mesh(block)
    x = torch.randn(block.n_points, 7)
    with torch.inference_mode():
        torch.testing.assert_close(
            PlainPhysGNN(network, graph)(x), network(x, graph), rtol=1e-4, atol=1e-5
        )


def test_onnxruntime_gives_the_same(store: Store, tmp_path: Path) -> None:
    onnxruntime, *_ = (
        pytest.importorskip(module, reason="extra [onnx] missing")
        for module in ("onnxruntime", "onnx", "onnxscript")
    )
    torch.manual_seed(0)
    model = build_model("physgnn", store.body, width=8).eval()
    model.fit(store, store.samples())
    config = {"model": "physgnn", "options": {"width": 8}}
    Checkpoint(model, {"config": config}).save(tmp_path / "run")
    export_onnx(tmp_path / "run", tmp_path / "model.onnx")
    assert not list(tmp_path.glob("*.data"))
    session = onnxruntime.InferenceSession(tmp_path / "model.onnx")
    for level in range(store.n_levels):
        x = model.encode(store.load_case(2, level))
        (found,) = session.run(None, {"features": x.numpy()})
        with torch.inference_mode():
            expected = model(x[None], graph_of(model.body))[0].numpy()
        np.testing.assert_allclose(found, expected, atol=1e-4)


def test_refuses_a_model_that_needs_a_solver(store: Store, tmp_path: Path) -> None:
    model = build_model("lifted", store.body, anchors=0, pod_modes=0)
    config = {"model": "lifted", "options": {"anchors": 0, "pod_modes": 0}}
    Checkpoint(model, {"config": config}).save(tmp_path / "run")
    with pytest.raises(InputError, match="only PhysGNN"):
        export_onnx(tmp_path / "run", tmp_path / "model.onnx")
    assert not (tmp_path / "model.onnx").exists()
