import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.lifted.model import LiftedModel
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.runs.folder import RunFolder
from physgnn.learning.runs.record import learnt_nothing
from physgnn.learning.training import callbacks
from physgnn.learning.training.config import TrainingConfig
from physgnn.learning.training.objective.losses import LOSSES
from physgnn.learning.training.training_run import train
from physgnn.versions import release

SMALL = TrainingConfig(
    options={"width": 8}, batch_size=4, max_epochs=4, plateau_patience=0, seed=3
)


def metrics(run: Path) -> list[dict[str, str]]:
    with (run / "metrics.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_loss_falls_and_the_best_weights_are_kept(
    store: Store, split: Split, tmp_path: Path
) -> None:
    told: list[tuple[int, int, str]] = []
    config = replace(SMALL, max_epochs=15)
    checkpoint = train(
        store, split, config, tmp_path / "run", progress=lambda *now: told.append(now)
    )
    rows = metrics(tmp_path / "run")
    losses = [float(row["validation_loss"]) for row in rows]
    assert float(rows[-1]["training_loss"]) < 0.8 * float(rows[0]["training_loss"])
    assert checkpoint.record["training"]["best_validation_loss"] == pytest.approx(
        min(losses)
    )
    assert told[-1][:2] == (1000, 1000)
    assert "epoch 14" in told[-1][2]
    best = int(np.argmin(losses)) + 1
    assert checkpoint.record["training"]["best_epoch"] == best
    assert not learnt_nothing(checkpoint.record)


def test_a_training_that_only_does_harm_leaves_what_the_physics_gives(
    store: Store, split: Split, tmp_path: Path
) -> None:
    harmful = replace(SMALL, model="lifted", options={}, learning_rate=0.5)
    kept = train(store, split, harmful, tmp_path / "run")
    losses = [float(row["validation_loss"]) for row in metrics(tmp_path / "run")]
    assert kept.record["training"]["best_validation_loss"] < min(losses)
    assert learnt_nothing(kept.record)
    assert (
        "before the first epoch" in RunFolder(tmp_path / "run").model_card.read_text()
    )
    path, level = split.test[0].tolist()
    load_case = store.load_case(path, level)
    untrained = LiftedModel(store.body)
    untrained.fit(store, split.train)
    expected = untrained.predict(load_case)
    np.testing.assert_allclose(kept.model.predict(load_case), expected, atol=1e-5)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"point_fraction": 0.3},
        {"model": "lifted", "options": {"width": 8, "any_axes": True}},
    ],
    ids=["all points", "some points", "lifted, along any axes"],
)
def test_a_resumed_run_equals_one_never_interrupted(
    store: Store, split: Split, tmp_path: Path, changes: dict[str, Any]
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    config = replace(SMALL, **changes)
    train(store, split, config, whole)
    train(store, split, replace(config, max_epochs=2), parts)
    train(store, split, config, parts, resume=True)
    for of_whole, of_parts in zip(metrics(whole), metrics(parts), strict=True):
        for name in ("epoch", "training_loss", "validation_loss", "learning_rate"):
            assert of_whole[name] == of_parts[name], name
    expected = Checkpoint.load(whole).model.state_dict()
    for name, value in Checkpoint.load(parts).model.state_dict().items():
        assert torch.equal(value, expected[name]), name


def test_a_loss_on_some_points_leads_where_that_on_all_does(
    store: Store, split: Split, tmp_path: Path
) -> None:
    whole, some = tmp_path / "whole", tmp_path / "some"
    config = replace(SMALL, max_epochs=15)
    train(store, split, config, whole)
    train(store, split, replace(config, point_fraction=0.3), some)
    first, last = (float(metrics(whole)[k]["validation_loss"]) for k in (0, -1))
    reached = float(metrics(some)[-1]["validation_loss"])
    assert reached < last + 0.3 * (first - last)


def test_training_begins_with_the_weights_of_another_run(
    store: Store, split: Split, tmp_path: Path
) -> None:
    start = train(store, split, replace(SMALL, max_epochs=2), tmp_path / "start")
    still = replace(SMALL, max_epochs=1, learning_rate=1e-12, weight_decay=0.0)
    begun = train(store, split, still, tmp_path / "begun", start=start)
    expected = start.model.state_dict()
    for name, value in begun.model.state_dict().items():
        torch.testing.assert_close(value, expected[name], rtol=0, atol=1e-9)
    other = replace(SMALL, options={"width": 6})
    with pytest.raises(
        InputError, match=r"begin with, configuration 3, .*, width 8 \(got .*width 6"
    ):
        train(store, split, other, tmp_path / "other", start=start)


class KilledError(Exception):
    """Stands for whatever ends a process."""


@pytest.mark.parametrize("batches", [2, 4, 5, 8])
def test_a_run_killed_within_an_epoch_loses_no_batch(
    store: Store,
    split: Split,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    batches: int,
) -> None:
    def kill(*_: object) -> None:
        nonlocal batches
        batches -= 1
        if batches < 0:
            raise KilledError

    config = replace(SMALL, batch_size=4)  # four batches an epoch
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    train(store, split, config, whole)
    monkeypatch.setattr(callbacks, "SECONDS_BETWEEN_STATES", 0.0)
    with pytest.raises(KilledError):
        train(store, split, config, parts, progress=kill)
    train(store, split, config, parts, resume=True)
    assert [row["validation_loss"] for row in metrics(whole)] == [
        row["validation_loss"] for row in metrics(parts)
    ]
    expected = Checkpoint.load(whole).model.state_dict()
    for name, value in Checkpoint.load(parts).model.state_dict().items():
        assert torch.equal(value, expected[name]), name


def test_a_loss_that_is_not_finite_stops_and_keeps_the_last_good_weights(
    store: Store, split: Split, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = tmp_path / "run"
    train(store, split, replace(SMALL, max_epochs=1), run)
    good = Checkpoint.load(run).model.state_dict()
    monkeypatch.setitem(LOSSES, "mean_euclidean", lambda y, _: y.sum() * torch.nan)
    with pytest.raises(InputError, match="lower learning_rate"):
        train(store, split, SMALL, run, resume=True)
    for name, value in Checkpoint.load(run).model.state_dict().items():
        assert torch.equal(value, good[name])


def test_the_budget_in_minutes_ends_with_a_validation(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = replace(SMALL, max_minutes=1e-6, max_epochs=50)
    train(store, split, config, tmp_path / "run")
    assert len(metrics(tmp_path / "run")) == 1


@pytest.mark.parametrize("clock", ["wall", "processor"])
def test_the_budget_is_counted_by_a_clock_and_recorded_by_both(
    store: Store, split: Split, tmp_path: Path, clock: str
) -> None:
    patient = replace(SMALL, max_epochs=10_000, early_stopping=10_000)
    config = replace(patient, max_minutes=0.02, clock=clock)
    spent = train(store, split, config, tmp_path / "run").record["training"]
    by_clock = {"wall": spent["minutes"], "processor": spent["processor_minutes"]}
    assert 0.02 <= by_clock[clock] < 0.2
    before = by_clock["processor"]
    longer = replace(config, max_minutes=0.03, clock="processor")
    spent = train(store, split, longer, tmp_path / "run", resume=True).record
    assert spent["training"]["processor_minutes"] > max(before, 0.03 - 1e-3)


def test_cosine_lets_the_learning_rate_fall_over_the_budget(
    store: Store, split: Split, tmp_path: Path
) -> None:
    train(store, split, replace(SMALL, schedule="cosine"), tmp_path / "run")
    rates = [float(row["learning_rate"]) for row in metrics(tmp_path / "run")]
    assert (np.diff(rates) < 0).all()
    assert rates[-1] < 0.1 * SMALL.learning_rate


def test_the_record_says_how_the_run_came_about(
    store: Store, split: Split, tmp_path: Path
) -> None:
    train(store, split, SMALL, tmp_path / "run")
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["config"]["options"]["normaliser"] == "training"
    assert record["config"]["options"]["width"] == 8
    assert record["config"]["seed"] == 3
    assert record["data"]["hash"] == store.content_hash()
    assert record["mesh_hash"] == store.mesh.content_hash
    assert record["split"]["name"] == "path"
    assert record["versions"]["torch"] == release("torch")


def test_refuses_to_overwrite_or_to_resume_something_else(
    store: Store, split: Split, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    with pytest.raises(InputError, match="no run to resume"):
        train(store, split, SMALL, run, resume=True)
    train(store, split, replace(SMALL, max_epochs=1), run)
    with pytest.raises(InputError, match="holds a run already"):
        train(store, split, SMALL, run)
    with pytest.raises(InputError, match="batch_size = 4"):
        train(store, split, replace(SMALL, batch_size=2), run, resume=True)
    other = replace(split, train=split.train[:-1])
    with pytest.raises(InputError, match="another split"):
        train(store, other, SMALL, run, resume=True)


@pytest.mark.parametrize(
    "wrong",
    [
        {"model": "none"},
        {"loss": "none"},
        {"schedule": "none"},
        {"clock": "none"},
        {"batch_size": 0},
        {"learning_rate": -1.0},
        {"weight_decay": -1.0},
        {"plateau_factor": 1.0},
        {"learning_rate": float("inf")},
        {"seed": -1},
        {"max_minutes": 0.0},
        {"point_fraction": 0.0},
        {"point_fraction": 1.01},
    ],
)
def test_config_refuses_what_makes_no_sense(wrong: dict[str, object]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        TrainingConfig(**wrong)


def test_refuses_an_option_the_model_has_not(
    store: Store, split: Split, tmp_path: Path
) -> None:
    config = TrainingConfig(options={"tallness": 3})
    with pytest.raises(InputError, match="no option 'tallness'"):
        train(store, split, config, tmp_path / "run")
