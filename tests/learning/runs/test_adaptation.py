"""A trained network on a body it never saw."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from meshes import block_mesh
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import graph_of
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.mechanics.body import Body
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
OPTIONS = {"anchors": 2, "k_hops": 2, "width": 8, "layers": 2, "pod_modes": 0}
CONFIG = TrainingConfig(model="lifted", options=OPTIONS, max_epochs=1)
STRETCH = np.diag([1.0, 1.4, 2.1]) + np.array([[0, 0.2, 0.1], [0, 0, 0.3], [0, 0, 0]])


@pytest.fixture
def trained(store: Store, split: Split, tmp_path: Path) -> Checkpoint:
    checkpoint = train(store, split, CONFIG, tmp_path / "run")
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for weight in checkpoint.model.parameters():
            weight.copy_(0.3 * torch.randn(weight.shape, generator=generator))
    return checkpoint


def patient() -> TetMesh:
    mesh = block_mesh(3, jitter=0.1)
    points = mesh.points @ STRETCH.T + 0.01 * mesh.points**2
    return TetMesh(points, mesh.cells, mesh.region, mesh.point_sets)


def loads(mesh: TetMesh, turn: np.ndarray = np.eye(3)) -> list[LoadCase]:  # noqa: B008
    nodes = mesh.point_set("loaded")
    push = np.random.default_rng(0).normal(size=(3, len(nodes), 3)) * 2e-3
    push[..., 2] -= 4e-3
    return [LoadCase(nodes, force @ turn.T) for force in push]


def predictions(
    trained: Checkpoint, mesh: TetMesh, cases: list[LoadCase]
) -> np.ndarray:
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"))
    forces = np.stack([case.on_points(mesh.n_points) for case in cases])
    model = adapt(trained, body, forces).model
    with torch.no_grad():
        inputs = torch.stack([model.encode(case) for case in cases])
        answer: np.ndarray = model(inputs, graph_of(body)).numpy()
    return answer


def test_it_finds_its_equilibria_and_keeps_what_was_learnt(trained: Checkpoint) -> None:
    mesh = patient()
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"))
    forces = np.stack([case.on_points(mesh.n_points) for case in loads(mesh)])
    model = adapt(trained, body, forces).model
    assert isinstance(model, LiftedModel)
    assert model.anchor_states.abs().amax((1, 2)).gt(0).all()
    assert model.near[mesh.point_set("loaded")].all()
    for name, weight in trained.model.local.state_dict().items():  # type: ignore[union-attr]
        assert torch.equal(model.local.state_dict()[name], weight)


def test_turning_the_patient_turns_the_answer(trained: Checkpoint) -> None:
    mesh = patient()
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    turned = TetMesh(
        mesh.points @ turn.T - 20.0, mesh.cells, mesh.region, mesh.point_sets
    )
    found = predictions(trained, turned, loads(mesh, turn))
    expected = predictions(trained, mesh, loads(mesh)) @ turn.T
    np.testing.assert_allclose(found, expected, atol=2e-3)  # the solver's tolerance


def test_node_order_does_not_matter(trained: Checkpoint) -> None:
    mesh = patient()
    order = np.random.default_rng(0).permutation(mesh.n_points)
    rank = np.argsort(order)
    shuffled = TetMesh(
        mesh.points[order],
        rank[mesh.cells].astype(np.int32),
        mesh.region,
        {name: rank[ids] for name, ids in mesh.point_sets.items()},
    )
    cases = [LoadCase(rank[case.nodes], case.forces) for case in loads(mesh)]
    found = predictions(trained, shuffled, cases)
    expected = predictions(trained, mesh, loads(mesh))[:, order]
    # of 150 mm, by random weights
    np.testing.assert_allclose(found, expected, atol=2e-2)


def test_no_load_no_displacement_and_fixed_points_stay_put(trained: Checkpoint) -> None:
    mesh = patient()
    cases = loads(mesh)
    none = LoadCase(cases[0].nodes, 1e-20 * cases[0].forces)
    answer = predictions(trained, mesh, [*cases, none])
    assert (answer[:, mesh.point_set("fixed")] == 0).all()
    assert np.abs(answer[-1]).max() < 1e-15
    assert np.abs(answer[0]).max() > 0.01


def test_small_loads_get_the_linear_solution(trained: Checkpoint) -> None:
    mesh = patient()
    rest = RestState(Body(mesh, MATERIALS))
    strong = loads(mesh)
    scales = np.array([0.08, 0.04, 0.02])
    weak = [LoadCase(strong[0].nodes, s * strong[0].forces) for s in scales]
    answers = predictions(trained, mesh, [*strong, *weak])[len(strong) :]
    linear = rest.solve(np.stack([case.on_points(mesh.n_points) for case in weak]))
    differences = np.abs(answers - linear).max(axis=(1, 2))
    assert np.polyfit(np.log(scales), np.log(differences), 1)[0] > 1.8


def test_it_reloads_and_still_names_the_meshes_it_was_trained_on(
    trained: Checkpoint, store: Store, tmp_path: Path
) -> None:
    mesh = patient()
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"))
    forces = np.stack([case.on_points(mesh.n_points) for case in loads(mesh)])
    adapted = adapt(trained, body, forces)
    adapted.save(tmp_path / "new")
    again = Checkpoint.load(tmp_path / "new")
    assert again.body.mesh.content_hash == mesh.content_hash
    assert again.record["data"]["meshes"] == [store.mesh.content_hash]
    case = loads(mesh)[0]
    assert torch.equal(adapted.model.encode(case), again.model.encode(case))


def test_a_network_that_belongs_to_its_mesh_is_refused(
    store: Store, split: Split, tmp_path: Path
) -> None:
    options = {**OPTIONS, "pod_modes": 2}
    trained = train(store, split, replace(CONFIG, options=options), tmp_path / "run")
    mesh = patient()
    body = Body(mesh, MATERIALS, mesh.point_set("fixed"))
    forces = np.stack([case.on_points(mesh.n_points) for case in loads(mesh)])
    with pytest.raises(InputError, match="pod_modes = 0"):
        adapt(trained, body, forces)
