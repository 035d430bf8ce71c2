"""Nothing is tested on what it was trained on."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.dataset.splits.load_identity import load_digests
from physgnn.dataset.splits.samples import split_path
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.measure.held_out import HeldOut, check_unseen

RUN = Path("run")


def record(store: Store, mesh: str | None = None, **data: Any) -> dict[str, Any]:
    return {
        "mesh_hash": mesh or store.mesh.content_hash,
        "data": {"hash": store.content_hash(), **data},
        "split": {"name": "path"},
    }


def test_a_split_gives_its_own_samples(store: Store) -> None:
    split = split_path(store)
    for given in ("path", split):
        held_out = HeldOut.of(store, given)
        np.testing.assert_array_equal(held_out.train, split.train)
        np.testing.assert_array_equal(held_out.test, split.test)
        check_unseen(record(store), held_out, RUN)


def test_a_new_mesh_is_tested_whole(store: Store) -> None:
    held_out = HeldOut.of(store, "mesh")
    assert len(held_out.train) == 0
    np.testing.assert_array_equal(held_out.test, store.samples())


def test_mesh_needs_one_that_no_training_saw(store: Store) -> None:
    """A run made ready for a mesh bears its hash, and those it was trained on."""
    held_out = HeldOut.of(store, "mesh")
    check_unseen(record(store, meshes=["another", "a third"]), held_out, RUN)
    with pytest.raises(InputError, match="trained on the mesh of"):
        check_unseen(record(store), held_out, RUN)
    seen = record(store, meshes=["another", store.mesh.content_hash])
    with pytest.raises(InputError, match="trained on the mesh of"):
        check_unseen(seen, held_out, RUN)


def test_samples_of_the_training_set_are_refused(store: Store) -> None:
    with pytest.raises(InputError, match="trained with split 'path', on"):
        check_unseen(record(store), HeldOut.of(store, "published"), RUN)


def test_other_data_on_the_same_mesh_is_all_new(store: Store) -> None:
    other = record(store, hash="of other data")
    check_unseen(other, HeldOut.of(store, "published"), RUN)


def test_load_paths_that_taught_are_refused_in_other_data(store: Store) -> None:
    """As of a dataset that was completed, or made longer, after the training."""
    split = split_path(store)
    other = record(store, hash="of the dataset before it was completed")
    other["split"]["load_paths"] = list(load_digests(store, split.train))
    check_unseen(other, HeldOut.of(store, "path"), RUN)
    other["split"]["load_paths"] += load_digests(store, split.test[:1])
    with pytest.raises(InputError, match="trained on 1 of the"):
        check_unseen(other, HeldOut.of(store, "path"), RUN)


def test_another_mesh_is_refused(store: Store) -> None:
    with pytest.raises(InputError, match="trained on another mesh"):
        check_unseen(record(store, mesh="another"), HeldOut.of(store, "path"), RUN)


def test_nothing_to_test_on_is_refused(store: Store) -> None:
    some = store.samples()
    with pytest.raises(InputError, match="no samples to evaluate"):
        HeldOut(store, "path", some, some[:0])
