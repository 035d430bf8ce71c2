"""Several bodies trained together: batches of one body each, all weights shared."""

import csv
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
import torch

from physgnn.dataset.splits.meshes import split_meshes
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.samples.batches import Share
from physgnn.learning.training.samples.multi_mesh import (
    MixedOrder,
    build_models,
    in_order,
    training_meshes,
)
from physgnn.learning.training.training_run import train
from physgnn.mechanics.body import Body
from physgnn.mechanics.equilibrium.solution import Solution

OPTIONS = {"anchors": 2, "k_hops": 2, "width": 8, "layers": 2, "pod_modes": 0}
CONFIG = TrainingConfig(
    model="lifted", options=OPTIONS, max_epochs=2, batch_size=4, learning_rate=1e-3
)


def solution(displacement: np.ndarray) -> Solution:
    n = len(displacement)
    return Solution(
        displacement=displacement,
        status=np.zeros(n, dtype=np.int8),
        residual=np.zeros(n),
        load_factors=np.arange(1, n + 1) / n,
        reached=1.0,
        message="",
        seconds=0.0,
        counts={},
    )


@pytest.fixture
def stores(store: Store, tmp_path: Path) -> list[Store]:
    """The store, and two on stretched copies of its mesh with the same answers."""
    made = [store]
    for k, stretch in enumerate((1.5, 0.7)):
        mesh = store.mesh
        other = TetMesh(mesh.points * stretch, mesh.cells, mesh.region, mesh.point_sets)
        copy = Store.create(
            tmp_path / f"other-{k}.zarr",
            Body(other, store.materials, store.fixed),
            [store.load_path(i) for i in range(store.n_paths)],
            provenance={},
        )
        for i in range(store.n_paths):
            copy.write(i, solution(store.displacement(i).astype(np.float64)))
        made.append(copy)
    return made


def test_every_batch_is_of_one_body_and_every_sample_is_seen() -> None:
    sizes = [10, 7, 0, 5]
    order = MixedOrder(sizes, 4, seed=1)
    batches = list(order)
    assert len(order) == len(batches)
    assert sorted(chain(*batches)) == list(range(22))
    body = [0] * 10 + [1] * 7 + [3] * 5
    assert all(len({body[i] for i in batch}) == 1 for batch in batches)
    order.set_epoch(1)
    assert list(order) != batches


@pytest.mark.parametrize("processes", [1, 2, 3])
def test_processes_share_validation_out(processes: int) -> None:
    parts = [in_order([10, 7], 4, Share(rank, processes)) for rank in range(processes)]
    assert sorted(chain(*chain(*parts))) == list(range(17))


def test_one_split_a_store(store: Store, split: Split) -> None:
    assert len(training_meshes(store, split)) == 1
    with pytest.raises(InputError, match="one split a store"):
        training_meshes([store, store], split)
    with pytest.raises(InputError, match="one store or more"):
        training_meshes([], [])


def test_whole_meshes_are_held_out(stores: list[Store]) -> None:
    splits = split_meshes(stores)
    assert len(splits[0].train) == len(stores[0].samples())
    assert [len(s.train) > 0 for s in splits].count(True) == 2
    assert all((len(s.train) > 0) != (len(s.validation) > 0) for s in splits)


def test_meshes_must_differ(store: Store) -> None:
    with pytest.raises(InputError, match="a mesh of its own"):
        split_meshes([store, store])
    with pytest.raises(InputError, match="two stores"):
        split_meshes([store])


def test_models_share_weights_and_nothing_else(stores: list[Store]) -> None:
    members = training_meshes(stores, split_meshes(stores))
    first, second, _ = build_models(members, CONFIG)
    assert isinstance(first, LiftedModel)
    assert isinstance(second, LiftedModel)
    assert second.local is first.local
    assert second.body.mesh is not first.body.mesh


def test_what_belongs_to_a_body_is_not_shared(stores: list[Store]) -> None:
    members = training_meshes(stores, split_meshes(stores))
    with pytest.raises(InputError, match="pod_modes = 0"):
        build_models(members, replace(CONFIG, options={**OPTIONS, "pod_modes": 3}))
    with pytest.raises(InputError, match="learns from one body"):
        build_models(members, TrainingConfig(options={"width": 8}))


def test_a_family_trains_and_its_record_names_every_mesh(
    stores: list[Store], tmp_path: Path
) -> None:
    run = tmp_path / "run"
    trained = train(stores, split_meshes(stores), CONFIG, run)
    hashes = [store.mesh.content_hash for store in stores]
    assert trained.record["data"]["meshes"] == hashes
    assert trained.body.mesh.content_hash == hashes[0]
    weights = torch.cat([w.flatten() for w in trained.model.local.parameters()])  # type: ignore[union-attr]
    assert weights.isfinite().all()
    with (run / "metrics.csv").open(newline="") as stream:
        losses = [float(row["training_loss"]) for row in csv.DictReader(stream)]
    assert losses[1] < losses[0]


def test_a_run_can_begin_with_the_weights_of_another(
    stores: list[Store], split: Split, tmp_path: Path
) -> None:
    begun = train(stores, split_meshes(stores), CONFIG, tmp_path / "run")
    config = replace(CONFIG, learning_rate=1e-12, max_epochs=1)
    start = Checkpoint.load(tmp_path / "run")
    tuned = train(stores[1], split, config, tmp_path / "tuned", start=start)
    for name, weight in begun.model.local.state_dict().items():  # type: ignore[union-attr]
        found = tuned.model.local.state_dict()[name]  # type: ignore[union-attr]
        torch.testing.assert_close(found, weight, atol=1e-6, rtol=1e-6)
    assert set(begun.record["data"]["meshes"]) == set(tuned.record["data"]["meshes"])
    assert tuned.record["start"]["data"]["hash"] == begun.record["data"]["hash"]


def test_weights_of_another_size_are_refused(
    store: Store, split: Split, tmp_path: Path
) -> None:
    begun = train(store, split, replace(CONFIG, max_epochs=1), tmp_path / "run")
    config = replace(CONFIG, options={**OPTIONS, "width": 10})
    with pytest.raises(InputError, match="width, layers, response_modes and imbalance"):
        train(store, split, config, tmp_path / "tuned", start=begun)
