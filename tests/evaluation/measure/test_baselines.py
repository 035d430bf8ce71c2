"""Baselines are made where they apply, and learn from what they may see."""

import numpy as np
import pytest

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.evaluation.measure.baselines import (
    QUICK,
    baseline_names,
    baseline_rows,
    named_baselines,
)
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.learning.models import model_class
from physgnn.learning.reduced_order import local_expansion as reduced

BASELINES = (
    "zero", "linear", "interpolation", "linear-regression", "decision-tree",
    "random-forest", "svr", "gpr", "rbf", "pod-network", "extra-trees",
    "mlp", "galerkin", "reduced",
)  # fmt: skip


def names(held_out: HeldOut, seeds: tuple[int, ...] = (0,)) -> list[str]:
    return [row.name for row in baseline_rows(BASELINES, held_out, seeds=seeds)]


def test_what_is_trained_step_by_step_is_no_baseline(store: Store) -> None:
    assert baseline_names() == (*BASELINES, "finite-element")
    with pytest.raises(InputError, match=r"no baseline 'lifted': .* train it"):
        baseline_rows(["lifted"], HeldOut.of(store, "path"))


def test_baselines_are_offered_where_they_apply(store: Store) -> None:
    """Interpolation needs the tested paths, learners need something to learn from."""
    published, path, mesh = (
        names(HeldOut.of(store, split)) for split in ("published", "path", "mesh")
    )
    assert published == [*BASELINES]
    assert path == [name for name in BASELINES if name != "interpolation"]
    assert mesh == ["zero", "linear"]


def test_the_reduced_model_stands_beside_loads_on_few_points_unless_named(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    held_out = HeldOut.of(store, "path")
    n_loaded = len(store.load_path(0).nodes)
    for few, offered in ((n_loaded, True), (n_loaded - 1, False)):
        monkeypatch.setattr(reduced, "FEW", few)
        assert ("reduced" in named_baselines("all", held_out)) == offered
        assert named_baselines("reduced", held_out) == ("reduced",)
    (row,) = baseline_rows(["reduced"], held_out)
    assert row.name == "reduced"


def test_only_what_draws_is_made_for_every_seed(store: Store) -> None:
    offered = names(HeldOut.of(store, "path"), seeds=(3, 4))
    assert offered.count("linear") == 1
    assert offered.count("extra-trees") == 2


def test_unknown_baseline_names_those_there_are(store: Store) -> None:
    with pytest.raises(InputError, match=r"no baseline 'magic' .*linear"):
        baseline_rows(["magic"], HeldOut.of(store, "path"))


def test_names_on_the_command_line(store: Store) -> None:
    held_out = HeldOut.of(store, "path")
    assert named_baselines("all", held_out) == tuple(BASELINES)
    assert named_baselines("quick", held_out) == QUICK
    assert named_baselines("zero, linear", held_out) == ("zero", "linear")
    assert named_baselines("zero,linear,zero", held_out) == ("zero", "linear")


def test_zero(store: Store) -> None:
    (row,) = baseline_rows(["zero"], HeldOut.of(store, "path"))
    assert not row.make()(store.load_case(0, 0)).displacement.any()


def test_learners_are_fitted_to_the_training_part_alone(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    held_out, seen = HeldOut.of(store, "path"), set()
    read = Store.displacement

    def watched(self: Store, path: int) -> np.ndarray:
        seen.add(path)
        return read(self, path)

    monkeypatch.setattr(Store, "displacement", watched)
    learners = [name for name in BASELINES if model_class(name).learns]
    assert len(learners) == 11
    for row in baseline_rows(learners, held_out):
        row.make()
    assert seen == set(held_out.train[:, 0].tolist())
