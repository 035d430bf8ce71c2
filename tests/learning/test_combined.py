"""The combined model: anchors where there are any, else the corrected expansion."""

from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.split import Split
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.combined import CombinedModel
from physgnn.learning.interface import Body
from physgnn.learning.reduced import ReducedModel
from physgnn.learning.training import train
from physgnn.learning.training_config import TrainingConfig
from physgnn.mechanics.loads import LoadCase, LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.mechanics.rest_state import RestState
from physgnn.mechanics.solver import SolverOptions, solve
from physgnn.prediction.predictor import Predictor

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
PUSH = np.array([[2e-2, 1e-2, -4e-2]])
SMALL = {"anchors": 2, "modes": 2, "width": 8, "layers": 1, "reach": 2}


def push(mesh: TetMesh, share: float = 1.0, which: int = 5) -> LoadCase:
    return LoadCase(mesh.point_set("loaded")[which : which + 1], share * PUSH)


def model_with_anchor(mesh: TetMesh) -> CombinedModel:
    """A model with random weights that knows one equilibrium, under 0.8 of the push."""
    torch.manual_seed(0)
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"))
    model = CombinedModel(body, **SMALL)
    torch.nn.init.normal_(model.local.last.weight)
    path = LoadPath(push(mesh).nodes, PUSH, np.array([0.8]))
    options = SolverOptions(tolerance_mm=1e-6)
    answer = solve(mesh, path, materials=MATERIALS, options=options)
    model.reduced.states[0] = torch.tensor(answer.displacement[0])
    model.reduced.loads[0] = torch.tensor(push(mesh, 0.8).on_points(mesh.n_points))
    return model


def test_known_points_get_the_reduced_models_answer(block: TetMesh) -> None:
    model = model_with_anchor(block)
    reduced = model.reduced
    assert isinstance(reduced, ReducedModel)
    case = push(block, 0.7)
    expected = reduced.encode(case).numpy()
    found = Predictor.of(model)(case).displacement
    np.testing.assert_allclose(found, expected, atol=1e-5)


@pytest.mark.parametrize("which", [5, 9])
def test_small_loads_get_the_linear_answer(block: TetMesh, which: int) -> None:
    tiny = push(block, 1e-4, which)
    linear = RestState(block, MATERIALS).solve(tiny.on_points(block.n_points))
    found = Predictor.of(model_with_anchor(block))(tiny).displacement
    assert np.abs(found - linear).max() < 0.02 * np.abs(linear).max()
    assert not found[block.point_set("fixed")].any()


def test_turning_body_and_load_turns_the_answer(block: TetMesh) -> None:
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    turned = TetMesh(block.points @ turn.T, block.cells, block.region, block.point_sets)
    model = model_with_anchor(block)
    other = CombinedModel(Body(turned, MATERIALS, model.body.fixed), **SMALL)
    other.local, other.coefficients = model.local, model.coefficients
    case = push(block, which=9)
    there = LoadCase(case.nodes, case.forces @ turn.T)
    np.testing.assert_allclose(
        Predictor.of(other)(there).displacement,
        Predictor.of(model)(case).displacement @ turn.T,
        atol=1e-4,
    )


def test_it_trains_saves_and_predicts(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = TrainingConfig(model="combined", options=SMALL, max_epochs=1)
    train(store, split, config, tmp_path / "run")
    case = store.load_case(*split.test[-1].tolist())
    found = Predictor.load(tmp_path / "run")(case).displacement
    assert np.isfinite(found).all()
    assert not found[store.fixed].any()


def test_several_bodies_are_refused(block: TetMesh) -> None:
    model = model_with_anchor(block)
    with pytest.raises(InputError, match="one body"):
        model.share_weights(model)
