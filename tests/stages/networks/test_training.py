"""What a training is asked for must be something that it uses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset import Preset
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.runs.checkpoint import read_record
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.devices import Machine
from physgnn.mechanics import LoadPath, NeoHookean
from physgnn.mechanics.loads.sampling import equal_levels
from physgnn.stages import train
from physgnn.stages.datasets.simulation import simulate_mesh
from physgnn.stages.networks.training import train_run


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"max_epochs": 5}, "--max-epochs"),
        ({"learning_rate": 0.1, "batch_size": 4}, "--batch-size, --learning-rate"),
        ({"memory_mb": 5.0}, "--memory-mb"),
        ({"device": "cuda", "devices": 2}, "--device, --devices"),
    ],
)
def test_settings_of_steps_are_refused_for_what_has_none(
    given: dict, named: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=f"not trained by steps: leave {named} out"):
        train(tmp_path / "loads.zarr", tmp_path / "run", model="extra-trees", **given)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("solver", ["physgnn", "mtled"])
def test_steps_to_equilibrium_are_taken_where_the_labels_are_in_it(
    block: TetMesh, solver: str, tmp_path: Path
) -> None:
    soft, stiff = NeoHookean(3000.0, 0.3), NeoHookean(7500.0, 0.3)
    preset = Preset({0: soft, 1: stiff}, pushes)
    simulate_mesh(block, preset, tmp_path / "loads.zarr", solver=solver)
    small = {"anchors": 1, "width": 4, "layers": 1, "response_modes": 2}
    config = TrainingConfig("lifted", options=small, max_epochs=1)
    asked = replace(config, options={**small, "relaxed_patches": 3})
    for name, given, patches in (("a", config, None), ("b", asked, 3)):
        run = tmp_path / name
        train_run(tmp_path / "loads.zarr", "path", given, run)
        options = read_record(run)["config"]["options"]
        own = solver == "physgnn"
        assert options["submodel_hops"] == (5 if own else 0)
        assert options["relaxed_patches"] == (patches or (8 if own else 0))


def test_a_run_to_begin_with_does_not_ask_for_them(
    block: TetMesh, tmp_path: Path
) -> None:
    preset = Preset({0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}, pushes)
    small = {"anchors": 1, "width": 4, "layers": 1, "response_modes": 2}
    config = TrainingConfig("lifted", options=small, max_epochs=1)
    for solver in ("physgnn", "mtled"):
        simulate_mesh(block, preset, tmp_path / f"{solver}.zarr", solver=solver)
    train_run(tmp_path / "physgnn.zarr", "path", config, tmp_path / "own")
    other = TrainingConfig("lifted", max_epochs=1)
    begun = tmp_path / "begun"
    train_run(tmp_path / "mtled.zarr", "path", other, begun, start=tmp_path / "own")
    options = read_record(begun)["config"]["options"]
    assert (options["submodel_hops"], options["relaxed_patches"]) == (0, 0)
    assert options["width"] == 4
    with pytest.raises(InputError, match="is of model 'lifted', not of 'cnn'"):
        train(
            tmp_path / "physgnn.zarr",
            tmp_path / "other",
            model="cnn",
            start=tmp_path / "own",
            max_epochs=1,
        )
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize("device", ["tpu", "xpu", "cuda"])
def test_a_device_that_is_not_there_is_refused(device: str) -> None:
    if device == "cuda" and torch.cuda.is_available():
        pytest.skip("this machine has one")
    with pytest.raises(InputError, match=rf"device must be .* \(got '{device}'\)"):
        Machine(device)


def pushes(_: TetMesh, loaded: np.ndarray) -> list[LoadPath]:
    forces = np.array([[0.0, 1e-3, -4e-3]])
    levels = equal_levels(2)
    return [LoadPath(loaded[[i]], (1 + i / 9) * forces, levels) for i in range(4)]
