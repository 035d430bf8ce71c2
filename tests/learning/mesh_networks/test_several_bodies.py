"""Weights of these networks serve any body, in the units they were trained in."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.splits.meshes import split_meshes
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.mesh_networks.meshgraphnet_model import MeshGraphNetModel
from physgnn.learning.mesh_networks.transolver_model import TransolverModel
from physgnn.learning.network import Network
from physgnn.learning.runs.adaptation import adapt
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.training_run import train
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution

SMALL = {
    "meshgraphnet": {"width": 8, "steps": 2},
    "transolver": {"width": 8, "layers": 2, "heads": 2, "slices": 4},
}
CLASSES = {"meshgraphnet": MeshGraphNetModel, "transolver": TransolverModel}
NAMES = [*SMALL]


def moved(body: Body, scale: float = 1.0) -> Body:
    """Return the body elsewhere, and larger."""
    mesh = body.mesh
    points = scale * mesh.points + np.array([7.0, -3.0, 11.0])
    other = TetMesh(points, mesh.cells, mesh.region, mesh.point_sets)
    return Body(other, body.materials, body.fixed)


@pytest.fixture
def stores(store: Store, tmp_path: Path) -> list[Store]:
    """The store, and one on a larger body, with stronger forces that move it more."""
    paths = [store.load_path(i) for i in range(store.n_paths)]
    strong = [replace(path, forces=3.0 * path.forces) for path in paths]
    other = Store.create(
        tmp_path / "other.zarr", moved(store.body, 1.5), strong, provenance={}
    )
    for i in range(store.n_paths):
        u = 5.0 * store.displacement(i).astype(np.float64)
        n = len(u)
        other.write(
            i,
            Solution(
                displacement=u,
                status=np.zeros(n, dtype=np.int8),
                residual=np.zeros(n),
                load_factors=np.arange(1, n + 1) / n,
                reached=1.0,
                message="",
                seconds=0.0,
                counts={},
            ),
        )
    return [store, other]


def trained(name: str, stores: list[Store], run: Path) -> Checkpoint:
    config = TrainingConfig(model=name, options=SMALL[name], max_epochs=2, batch_size=4)
    return train(stores, split_meshes(stores), config, run)


@pytest.mark.parametrize("name", NAMES)
def test_all_bodies_have_the_units_of_the_first(
    name: str, stores: list[Store], split: Split
) -> None:
    first, second = (CLASSES[name](store.body, **SMALL[name]) for store in stores)
    second.share_weights(first)
    assert second.network is first.network
    for model, store in ((first, stores[0]), (second, stores[1])):
        model.fit(store, split.train)
    assert second.inputs.displacement_unit == first.inputs.displacement_unit > 0
    one, thrice = (store.load_case(0, 1) for store in stores)
    np.testing.assert_allclose(
        second.encode(thrice)[:, 3:], 3.0 * first.encode(one)[:, 3:], rtol=1e-5
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_body_elsewhere_moves_as_the_one_trained_on(
    name: str, stores: list[Store], tmp_path: Path
) -> None:
    run = trained(name, stores, tmp_path / "run")
    body = moved(stores[0].body)
    forces = np.zeros((1, body.mesh.n_points, 3))
    adapted = adapt(Checkpoint.load(tmp_path / "run"), body, forces).model
    case = stores[0].load_case(1, 2)
    there, here = adapted.predict(case), run.model.predict(case)
    assert np.abs(here).max() > 0
    np.testing.assert_allclose(there, here, atol=1e-4 * np.abs(here).max())


@pytest.mark.parametrize("name", NAMES)
def test_a_run_can_begin_with_the_weights_and_units_of_another(
    name: str, stores: list[Store], split: Split, tmp_path: Path
) -> None:
    begun = trained(name, stores, tmp_path / "run").model
    config = TrainingConfig(
        model=name, options=SMALL[name], max_epochs=1, learning_rate=1e-12
    )
    start = Checkpoint.load(tmp_path / "run")
    tuned = train(stores[1], split, config, tmp_path / "tuned", start=start).model
    assert isinstance(begun, Network)
    assert isinstance(tuned, Network)
    theirs = begun.state_dict()
    for key, value in tuned.state_dict().items():
        torch.testing.assert_close(value, theirs[key], atol=1e-6, rtol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_weights_that_do_not_fit_are_refused(name: str, store: Store) -> None:
    own = CLASSES[name](store.body, **SMALL[name])
    wider = CLASSES[name](store.body, **{**SMALL[name], "width": 16})
    with pytest.raises(InputError, match="must be those of the other network"):
        own.share_weights(wider)
    (other,) = set(NAMES) - {name}
    with pytest.raises(InputError, match=f"a {name} takes the weights of another"):
        own.share_weights(CLASSES[other](store.body, **SMALL[other]))
