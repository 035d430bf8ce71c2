"""What an evaluation tests on, and that no tested run has seen it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from physgnn.arrays import IntArray
from physgnn.dataset.splits.load_identity import load_digests
from physgnn.dataset.splits.samples import MESH, SPLITS, Split, named_split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.runs.checkpoint import check_mesh
from physgnn.learning.runs.record import trained_meshes

NONE = np.empty((0, 2), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Samples to test on.

    Parameters
    ----------
    store : Store
    split : str
        Name of the split, for the report.
    train, test : (n, 2) integer arrays
        Rows of (path, level): what learners that are trained for the evaluation may
        see, and what all are tested on.

    Raises
    ------
    InputError
        If there is nothing to test on.
    """

    store: Store
    split: str
    train: IntArray
    test: IntArray

    def __post_init__(self) -> None:
        if len(self.test) == 0:
            raise InputError(
                f"split '{self.split}' has no samples to evaluate: simulate more load "
                "paths"
            )

    @classmethod
    def of(cls, store: Store, split: str | Split) -> "HeldOut":
        """Return the test samples of a split; of ``mesh``, all there are.

        Raises
        ------
        InputError
            If there is no such split, or it does not fit the store.
        """
        if split == MESH:
            return cls(store, MESH, NONE, store.samples())
        if not isinstance(split, Split) and split not in SPLITS:
            names = ", ".join(sorted([MESH, *SPLITS]))
            raise InputError(f"no split '{split}' (there are: {names})")
        found = split if isinstance(split, Split) else named_split(split, store)
        return cls(store, found.name, found.train, found.test)


def check_unseen(record: Mapping[str, Any], held_out: HeldOut, run: Path) -> None:
    """Raise InputError if a run was trained on what it would be tested on.

    Parameters
    ----------
    record : mapping
        The run's own, of run.json.
    held_out : HeldOut
        Tests.
    run : path
        Its folder, for the message.
    """
    store = held_out.store
    if held_out.split == MESH:
        if store.mesh.content_hash in trained_meshes(record):
            raise InputError(
                f"{run} was trained on the mesh of {store.path}: test it on a mesh it "
                "has never seen, or choose another split"
            )
        return
    check_mesh(record, store.mesh, run)
    if record["data"]["hash"] != store.content_hash():
        _check_load_paths(record, held_out, run)
        return
    trained = named_split(record["split"]["name"], store)
    seen = {tuple(row) for row in np.concatenate([trained.train, trained.validation])}
    overlap = sum(tuple(row) in seen for row in held_out.test)
    if overlap:
        raise InputError(
            f"{run} was trained with split '{trained.name}', on {overlap} of the "
            f"{len(held_out.test)} test samples of split '{held_out.split}': evaluate "
            f"it with --split {trained.name}, or train with --split {held_out.split}"
        )


def _check_load_paths(record: Mapping[str, Any], held_out: HeldOut, run: Path) -> None:
    """Raise InputError if other data have load paths that a run was trained on.

    A dataset that was completed after the training, or drawn alike and made longer, has
    other splits. Runs of before they noted their load paths are believed.
    """
    taught = set(record["split"].get("load_paths", ()))
    tested = load_digests(held_out.store, held_out.test)
    overlap = sum(name in taught for name in tested)
    if overlap:
        raise InputError(
            f"{run} was trained on {overlap} of the {len(tested)} load paths of "
            f"{held_out.store.path} that split '{held_out.split}' tests: the dataset "
            "is not the one it was trained on, but has the same load paths; train it "
            "on this one, or evaluate it on load paths of another seed"
        )
