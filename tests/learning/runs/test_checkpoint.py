import json
from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.io import write_mesh
from physgnn.learning.graph import graph_of
from physgnn.learning.models import build_model, resolved_options
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder

CONFIG = {"model": "physgnn", "options": {"width": 8}}


@pytest.fixture
def checkpoint(store: Store, split: Split) -> Checkpoint:
    torch.manual_seed(0)
    model = build_model("physgnn", store.body, width=8)
    model.fit(store, split.train)
    return Checkpoint(model.eval(), {"config": CONFIG})


def test_reloaded_model_answers_bit_for_bit(
    checkpoint: Checkpoint, store: Store, tmp_path: Path
) -> None:
    checkpoint.save(tmp_path / "run")
    again = Checkpoint.load(tmp_path / "run")
    case = store.load_case(5, 2)
    x = again.model.encode(case)
    assert torch.equal(x, checkpoint.model.encode(case))
    with torch.inference_mode():
        y = again.model(x[None], graph_of(again.body))
        assert torch.equal(y, checkpoint.model(x[None], graph_of(checkpoint.body)))
    assert not again.model.training
    options = resolved_options(CONFIG["model"], CONFIG["options"])
    assert again.record["config"] == {**CONFIG, "options": options}
    assert again.body.materials == store.materials
    np.testing.assert_array_equal(again.body.fixed, store.fixed)
    assert again.body.mesh.point_sets.keys() == store.mesh.point_sets.keys()


def test_leaves_no_unfinished_file(checkpoint: Checkpoint, tmp_path: Path) -> None:
    checkpoint.save(tmp_path)
    checkpoint.save(tmp_path)
    files = {file.name for file in tmp_path.iterdir() if file.suffix != ".zarr"}
    assert files == {"weights.safetensors", "run.json", "case.vtu", "manifest.json"}


def test_refuses_another_mesh(checkpoint: Checkpoint, tmp_path: Path) -> None:
    checkpoint.save(tmp_path)
    mesh = checkpoint.body.mesh
    moved = TetMesh(mesh.points + 1.0, mesh.cells, mesh.region, mesh.point_sets)
    write_mesh(RunFolder(tmp_path).case, moved)
    with pytest.raises(InputError, match="another mesh"):
        Checkpoint.load(tmp_path)


@pytest.mark.parametrize("name", ["weights.safetensors", "run.json", "case.vtu"])
def test_refuses_a_folder_without_one_of_its_files(
    checkpoint: Checkpoint, tmp_path: Path, name: str
) -> None:
    checkpoint.save(tmp_path)
    (tmp_path / name).unlink()
    with pytest.raises(InputError, match=name):
        Checkpoint.load(tmp_path)


def test_refuses_damage_and_other_versions(
    checkpoint: Checkpoint, tmp_path: Path
) -> None:
    checkpoint.save(tmp_path)
    weights = RunFolder(tmp_path).weights.read_bytes()
    RunFolder(tmp_path).weights.write_bytes(weights[: len(weights) // 2])
    with pytest.raises(InputError, match="doesn't hold the weights"):
        Checkpoint.load(tmp_path)
    record = json.loads(RunFolder(tmp_path).record.read_text())
    RunFolder(tmp_path).record.write_text(json.dumps({**record, "format_version": 99}))
    with pytest.raises(InputError, match="version 99"):
        Checkpoint.load(tmp_path)
    RunFolder(tmp_path).record.write_text("{")
    with pytest.raises(InputError, match="damaged"):
        Checkpoint.load(tmp_path)
