"""What the lifted network must be, whatever its weights."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.graph import graph_of
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.lifted.own_axes import body_axes
from physgnn.learning.models import build_model
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.mechanics.body import Body
from physgnn.mechanics.elements.tet4 import internal_force
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase
from physgnn.mechanics.materials import NeoHookean

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
OPTIONS = {
    "anchors": 2, "k_hops": 2, "width": 8, "layers": 2, "pod_modes": 3,
    "response_modes": 4, "submodel_hops": 5, "any_axes": False,
    "exponential": True, "imbalance": True, "relaxed_patches": 4,
}  # fmt: skip


def slab(block: TetMesh) -> TetMesh:
    """The block, sheared and stretched: its principal axes are well apart."""
    shear = np.array([[1.0, 0.2, 0.1], [0.0, 1.6, 0.3], [0.0, 0.0, 2.3]])
    points = block.points @ shear.T + 0.01 * block.points**2
    return TetMesh(points, block.cells, block.region, block.point_sets)


def body_of(mesh: TetMesh) -> Body:
    return Body(mesh, MATERIALS, mesh.point_set("fixed"))


def load_of(mesh: TetMesh, scale: float = 1.0) -> LoadCase:
    forces = np.array([[2.0, 1.0, -4.0], [-1.0, 2.0, -3.0]]) * 1e-2
    return LoadCase(mesh.point_set("loaded")[4:6], scale * forces)


def with_random_weights(model: LiftedModel) -> LiftedModel:
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for weight in model.parameters():
            weight.copy_(0.3 * torch.randn(weight.shape, generator=generator))
        for shapes in (model.modes, model.responses):
            shapes.copy_(0.1 * torch.randn(shapes.shape, generator=generator))
    return model.eval()


def predict(model: LiftedModel, load_case: LoadCase) -> Tensor:
    with torch.no_grad():
        answer: Tensor = model(model.encode(load_case)[None], graph_of(model.body))[0]
    return answer


@pytest.fixture(params=[0, 3], ids=["local only", "with modes"])
def model(block: TetMesh, request: pytest.FixtureRequest) -> LiftedModel:
    options = {**OPTIONS, "pod_modes": request.param}
    return with_random_weights(LiftedModel(body_of(slab(block)), **options))


@pytest.fixture
def fitted(store: Store, split: Split) -> LiftedModel:
    model = LiftedModel(store.body, **OPTIONS)
    model.fit(store, split.train)
    return model


def test_no_load_gives_no_displacement(model: LiftedModel) -> None:
    inputs = torch.zeros(1, model.body.mesh.n_points, 15)
    assert (model(inputs, graph_of(model.body)) == 0).all()


def test_fixed_points_stay_put_exactly(model: LiftedModel) -> None:
    answer = predict(model, load_of(model.body.mesh))
    assert (answer[model.body.fixed] == 0).all()
    assert answer.abs().max() > 0.1


def test_small_loads_converge_to_the_linear_solution_at_second_order(
    model: LiftedModel,
) -> None:
    mesh = model.body.mesh
    rest = RestState(Body(mesh, MATERIALS))
    scales = np.array([0.2, 0.1, 0.05, 0.025])
    differences = []
    for scale in scales:
        case = load_of(mesh, scale)
        linear = rest.solve(case.on_points(mesh.n_points))
        differences.append(np.abs(predict(model, case).numpy() - linear).max())
    rate = np.polyfit(np.log(scales), np.log(differences), 1)[0]
    assert rate > 1.9


def test_turning_body_and_load_turns_the_answer(model: LiftedModel) -> None:
    mesh = model.body.mesh
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    points = mesh.points @ turn.T + 30.0
    turned = TetMesh(points, mesh.cells, mesh.region, mesh.point_sets)
    options = {**OPTIONS, "pod_modes": len(model.modes)}
    other = LiftedModel(body_of(turned), **options)
    other.load_state_dict(model.state_dict())
    case = load_of(mesh)
    answer = predict(other.eval(), LoadCase(case.nodes, case.forces @ turn.T))
    expected = predict(model, case).numpy() @ turn.T
    np.testing.assert_allclose(answer.numpy(), expected, atol=1e-4)


def test_node_order_does_not_matter(model: LiftedModel) -> None:
    mesh = model.body.mesh
    order = np.random.default_rng(0).permutation(mesh.n_points)
    rank = np.argsort(order)
    shuffled = TetMesh(
        mesh.points[order],
        rank[mesh.cells].astype(np.int32),
        mesh.region,
        {name: rank[ids] for name, ids in mesh.point_sets.items()},
    )
    options = {**OPTIONS, "pod_modes": len(model.modes)}
    other = LiftedModel(body_of(shuffled), **options)
    state = model.state_dict()
    for name in ("anchor_states", "responses", "modes"):
        state[name] = state[name][:, order]
    state["near"] = state["near"][order]
    other.load_state_dict(state)
    case = load_of(mesh)
    answer = predict(other.eval(), LoadCase(rank[case.nodes], case.forces))
    expected = predict(model, case).numpy()[order]
    # of several millimetres, in float32, summed in another order
    np.testing.assert_allclose(answer.numpy(), expected, atol=5e-4)


def test_untrained_it_is_the_expansion(fitted: LiftedModel, store: Store) -> None:
    fitted.coefficients = None
    case = store.load_case(5, 3)
    force = case.on_points(store.mesh.n_points) @ body_axes(store.mesh).T
    expected = fitted.expansion.expand(force).displacement @ body_axes(store.mesh)
    np.testing.assert_allclose(predict(fitted, case).numpy(), expected, atol=1e-5)


def test_fit_marks_only_points_near_loads_and_fills_modes(
    fitted: LiftedModel, store: Store, split: Split
) -> None:
    loaded = {n for i in split.train[:, 0] for n in store.load_path(int(i)).nodes}
    assert fitted.near[list(loaded)].all()
    assert fitted.near.sum() < store.mesh.n_points
    assert (fitted.modes[:, store.fixed] == 0).all()
    assert fitted.anchor_states.abs().amax((1, 2)).gt(0).all()


@pytest.mark.parametrize("modes", [0, 3])
def test_a_trained_checkpoint_reloads_bit_for_bit(
    store: Store, split: Split, tmp_path: Path, modes: int
) -> None:
    options = {**OPTIONS, "pod_modes": modes}
    config = TrainingConfig(
        model="lifted", options=options, max_epochs=2, batch_size=4, learning_rate=1e-3
    )
    trained = train(store, split, config, tmp_path / "run").model
    again = Checkpoint.load(tmp_path / "run").model
    case = store.load_case(5, 3)
    assert isinstance(trained, LiftedModel)
    assert isinstance(again, LiftedModel)
    assert torch.equal(predict(trained.eval(), case), predict(again, case))


def test_a_force_moves_the_body_as_far_as_the_modes_span_it(
    store: Store,
) -> None:
    """With as many modes as forces have components, Φ Φᵀ f is the linear solution."""
    loaded = store.load_path(0).nodes[:2]
    forces = np.zeros((1, store.mesh.n_points, 3))
    forces[0, loaded] = [[0.01, 0.0, -0.02], [0.0, 0.03, 0.01]]
    all_modes = 3 * store.mesh.n_points  # what is too many stays zero
    whole = LiftedModel(store.body, **{**OPTIONS, "response_modes": all_modes})
    whole.expect(forces)
    cpu = torch.device("cpu")
    points = whole._prepared.region_on(cpu).points
    turned = forces @ body_axes(store.mesh).T
    pushed = torch.from_numpy(turned[:, points.numpy()].astype(np.float32))
    moved = whole._prepared.carried_on(cpu)(pushed).numpy()[0] @ body_axes(store.mesh)
    expected = RestState(store.body).solve(forces[0])
    np.testing.assert_allclose(moved, expected, atol=1e-4 * np.abs(expected).max())


def test_it_learns_after_it_has_predicted(fitted: LiftedModel, store: Store) -> None:
    """What a prediction keeps for the next one must serve a gradient, too."""
    inputs = fitted.encode(store.load_case(5, 3))[None]
    with torch.inference_mode():
        fitted(inputs, graph_of(fitted.body))
    fitted(inputs, graph_of(fitted.body)).sum().backward()
    assert fitted.local.last.weight.grad is not None
    assert fitted.local.last.weight.grad[3:].any()


def test_along_any_axes_it_sees_others_each_time_but_only_while_it_learns(
    block: TetMesh,
) -> None:
    body = body_of(slab(block))
    usual, anyhow = (
        with_random_weights(LiftedModel(body, **{**OPTIONS, "any_axes": drawn}))
        for drawn in (False, True)
    )
    case = load_of(body.mesh)
    assert torch.equal(predict(usual, case), predict(anyhow, case))
    usual.train(), anyhow.train()
    assert torch.equal(predict(usual, case), predict(usual, case))
    first, second = predict(anyhow, case), predict(anyhow, case)
    assert (first - second).abs().max() > 1e-4 * first.abs().max()
    graph = graph_of(body)
    anyhow(anyhow.encode(case)[None], graph).square().sum().backward()
    for weight in anyhow.local.parameters():
        assert weight.grad is not None
        assert weight.grad.any()


def test_runs_of_before_response_modes_have_none(
    store: Store, split: Split, tmp_path: Path
) -> None:
    options = {**OPTIONS, "response_modes": 0}
    config = TrainingConfig(model="lifted", options=options, max_epochs=1)
    trained = train(store, split, config, tmp_path / "run").model
    file = RunFolder(tmp_path / "run").record
    record = json.loads(file.read_text())
    del record["config"]["options"]["response_modes"]
    record.pop("manifest")  # so that what is changed by hand is opened
    RunFolder(tmp_path / "run").manifest.unlink()
    file.write_text(json.dumps(record))
    again = Checkpoint.load(tmp_path / "run")
    assert again.record["config"]["options"] == options
    case = store.load_case(5, 3)
    assert isinstance(trained, LiftedModel)
    assert isinstance(again.model, LiftedModel)
    assert torch.equal(predict(trained.eval(), case), predict(again.model, case))


def test_size_is_some_tens_of_thousands(block: TetMesh) -> None:
    model = LiftedModel(body_of(block))
    assert 1e4 < sum(p.numel() for p in model.parameters()) < 6e4


def test_what_it_sees_of_the_forces_is_what_is_out_of_balance_near_the_load(
    fitted: LiftedModel, store: Store
) -> None:
    case = store.load_case(5, 3)
    inputs, axes = fitted.encode(case).double().numpy(), fitted.axes.double().numpy()
    inner, _ = internal_force(store.body.elements, inputs[:, :3] @ axes)
    left = case.on_points(store.mesh.n_points) - inner
    left[store.body.fixed] = 0.0
    left[~fitted.near.numpy()] = 0.0
    assert np.abs(left).max() > 1e-5
    np.testing.assert_allclose(inputs[:, 12:] @ axes, left, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-6, 1e-12, 1e-30])
def test_next_to_no_load_is_answered_whatever_rounding_leaves_out_of_balance(
    fitted: LiftedModel, store: Store, scale: float
) -> None:
    case = store.load_case(5, 3)
    tiny = replace(case, forces=scale * case.forces)
    model = with_random_weights(fitted)
    found, linear = predict(model, tiny).numpy(), model.linear(tiny)
    assert np.abs(found - linear).max() <= 1e-2 * np.abs(linear).max()


def test_without_what_came_later_its_inputs_are_those_of_before(
    store: Store, split: Split
) -> None:
    before = {**OPTIONS, "exponential": False, "imbalance": False}
    model = LiftedModel(store.body, **before)
    model.fit(store, split.train)
    case = store.load_case(5, 3)
    inputs = model.encode(case)
    assert inputs.shape == (store.mesh.n_points, 12)
    terms = model.expansion.expand(
        case.on_points(store.mesh.n_points) @ model._axes64.T
    )
    assert (terms.third == 0).all()
    np.testing.assert_allclose(
        inputs[:, :3], terms.anchor + terms.first + terms.second, atol=1e-5
    )


def test_refuses_options_out_of_range(block: TetMesh) -> None:
    with pytest.raises(InputError, match="layers ≥ 1"):
        build_model("lifted", body_of(block), layers=0)
