"""What the reduced model must be, and that it runs as every model does."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.models import build_model
from physgnn.learning.reduced_order import local_expansion as reduced
from physgnn.learning.reduced_order.local_expansion import ReducedModel
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train as train_model
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solver import SolverOptions, solve
from physgnn.mechanics.linear.linear_elasticity import RestState
from physgnn.mechanics.loads.paths import LoadCase, LoadPath
from physgnn.mechanics.materials import NeoHookean
from physgnn.prediction.predictor import Predictor
from physgnn.stages.networks.training import train_run as train

MATERIALS = {0: NeoHookean(3000.0, 0.3), 1: NeoHookean(7500.0, 0.3)}
PUSH = np.array([[2e-2, 1e-2, -4e-2]])
EXACT = SolverOptions(tolerance_mm=1e-6)


def body_of(mesh: TetMesh) -> Body:
    return Body(mesh, MATERIALS, mesh.point_set("fixed"))


def push(mesh: TetMesh, share: float = 1.0) -> LoadCase:
    return LoadCase(mesh.point_set("loaded")[5:6], share * PUSH)


def answer(model: ReducedModel, case: LoadCase) -> np.ndarray:
    return model.predict(case)


def with_anchor(mesh: TetMesh, share: float) -> ReducedModel:
    """A model that knows the equilibrium at a share of the push."""
    model = ReducedModel(body_of(mesh), anchors=2)
    path = LoadPath(push(mesh).nodes, PUSH, np.array([share]))
    solution = solve(mesh, path, materials=MATERIALS, options=EXACT)
    model.states[0] = solution.displacement[0]
    model.loads[0] = push(mesh, share).on_points(mesh.n_points)
    model.forget()
    return model


@pytest.mark.parametrize("anchored", [False, True])
def test_small_loads_get_the_linear_answer(block: TetMesh, anchored: bool) -> None:
    model = with_anchor(block, 0.02) if anchored else ReducedModel(body_of(block))
    tiny = push(block, 1e-3)
    linear = RestState(Body(block, MATERIALS)).solve(tiny.on_points(block.n_points))
    error = np.abs(answer(model, tiny) - linear).max()
    assert error < 0.01 * np.abs(linear).max()


def test_an_anchors_own_load_gets_its_state(block: TetMesh) -> None:
    model = with_anchor(block, 0.8)
    np.testing.assert_allclose(
        answer(model, push(block, 0.8)), model.states[0], atol=1e-5
    )


def test_an_anchor_brings_loads_near_it_nearer(block: TetMesh) -> None:
    path = LoadPath(push(block).nodes, PUSH, np.array([1.0]))
    truth = solve(block, path, materials=MATERIALS, options=EXACT).displacement[0]
    from_rest = answer(ReducedModel(body_of(block), k_hops_from_rest=1), push(block))
    anchored = answer(with_anchor(block, 0.8), push(block))
    linear = RestState(Body(block, MATERIALS)).solve(
        push(block).on_points(block.n_points)
    )
    errors = [np.abs(u - truth).max() for u in (linear, from_rest, anchored)]
    assert errors[1] < errors[0]
    assert errors[2] < 0.5 * errors[1]
    assert not anchored[block.point_set("fixed")].any()


def test_repairs_start_from_the_anchor_next_to_a_load(block: TetMesh) -> None:
    model = with_anchor(block, 0.8)
    for share, state in ((0.7, model.states[0]), (0.1, 0.0 * block.points)):
        case = push(block, share)
        known = model.nearest_reference(case.on_points(block.n_points))
        np.testing.assert_array_equal(known.displacement, state)


def test_an_answer_out_of_equilibrium_is_flagged(block: TetMesh) -> None:
    model = ReducedModel(body_of(block))
    predictor = Predictor(model)
    assert predictor(push(block)).status.usable
    assert not predictor(push(block, 1e4)).status.usable


def test_turning_body_and_load_turns_the_answer(block: TetMesh) -> None:
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    turned = TetMesh(block.points @ turn.T, block.cells, block.region, block.point_sets)
    case = push(block)
    u = answer(ReducedModel(body_of(block)), case)
    rotated = answer(
        ReducedModel(body_of(turned)), LoadCase(case.nodes, case.forces @ turn.T)
    )
    np.testing.assert_allclose(rotated, u @ turn.T, atol=1e-5)


def test_the_order_of_points_does_not_matter(block: TetMesh) -> None:
    order = np.random.default_rng(0).permutation(block.n_points)
    place = np.argsort(order)
    shuffled = TetMesh(
        block.points[order],
        place[block.cells].astype(np.int32),
        block.region,
        {name: np.sort(place[ids]) for name, ids in block.point_sets.items()},
    )
    case = push(block)
    u = answer(ReducedModel(body_of(block)), case)
    mixed = answer(
        ReducedModel(body_of(shuffled)), LoadCase(place[case.nodes], case.forces)
    )
    np.testing.assert_allclose(mixed, u[order], atol=1e-5)


@pytest.mark.parametrize(
    ("name", "options"),
    [("reduced", {"anchors": 3}), ("galerkin", {"pod_modes": 3, "k_hops": 1})],
)
def test_a_run_is_fitted_saved_and_predicts(
    store: Store, split: Split, tmp_path: Path, name: str, options: dict[str, int]
) -> None:
    config = TrainingConfig(model=name, options=options)
    checkpoint = train_model(store, split, config, tmp_path / "run")
    case = store.load_case(*split.test[-1].tolist())
    predicted = Predictor.load(tmp_path / "run")(case).displacement
    assert predicted.shape == store.mesh.points.shape
    assert np.isfinite(predicted).all()
    np.testing.assert_array_equal(checkpoint.model.predict(case), predicted)
    with pytest.raises(InputError, match="holds a run already"):
        train_model(store, split, config, tmp_path / "run")


def test_there_are_no_more_anchors_than_memory_holds(
    store: Store, split: Split, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = ReducedModel(store.body, anchors=3)
    for n_bytes, n_anchors in ((2**30, 3), (1, 1)):
        monkeypatch.setattr(reduced, "MAX_BYTES", n_bytes)
        model.fit(store, split.train)
        assert model.loads.any(axis=(1, 2)).sum() == n_anchors


@pytest.mark.parametrize("options", [{"anchors": -1}, {"nearest_anchors": 0}])
def test_options_out_of_range_are_refused(
    block: TetMesh, options: dict[str, int]
) -> None:
    with pytest.raises(InputError, match="nearest_anchors ≥ 1"):
        ReducedModel(body_of(block), **options)


def test_several_bodies_are_refused(store: Store, split: Split, tmp_path: Path) -> None:
    config = TrainingConfig(model="reduced")
    with pytest.raises(InputError, match="one dataset"):
        train_model([store, store], [split, split], config, tmp_path / "run")


def test_the_stage_behind_the_command_fits_and_calibrates(
    store: Store, tmp_path: Path
) -> None:
    config = TrainingConfig(model="reduced", options={"anchors": 2})
    train(store.path, "path", config, tmp_path / "run")
    case = store.load_case(0, 1)
    prediction = Predictor.load(tmp_path / "run")(case)
    assert prediction.error_estimate_mm is not None


@pytest.mark.parametrize("name", ["galerkin", "reduced"])
def test_averaged_elements_are_refused(block: TetMesh, name: str) -> None:
    body = replace(body_of(block), element="tet4-averaged")
    with pytest.raises(InputError, match="tet4"):
        build_model(name, body)
