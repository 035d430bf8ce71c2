"""Runs that differ in their seed make one row; others are told apart."""

import json
from pathlib import Path
from typing import Any

import pytest

from physgnn.errors import InputError
from physgnn.evaluation.measure.rows import repaired_row, run_rows
from physgnn.learning.runs.checkpoint import FORMAT_VERSION
from physgnn.learning.runs.folder import RunFolder


def fake_run(folder: Path, seed: int, *, split: str = "a", **config: Any) -> Path:
    """A run folder as far as its row goes."""
    folder.mkdir()
    RunFolder(folder).weights.write_bytes(bytes([seed]))
    RunFolder(folder).case.write_text("")
    record = {
        "format_version": FORMAT_VERSION,
        "config": {"model": "lifted", "width": 8, "seed": seed, **config},
        "split": {"hash": split},
        "data": {"hash": "d"},
        "training": {"minutes": 2.5},
    }
    RunFolder(folder).record.write_text(json.dumps(record))
    return folder


def test_seeds_share_the_models_name(tmp_path: Path) -> None:
    runs = [fake_run(tmp_path / f"run-{seed}", seed) for seed in (0, 1)]
    rows = run_rows(runs, store=None)
    assert [(row.name, row.seed, row.minutes) for row in rows] == [
        ("lifted", 0, 2.5),
        ("lifted", 1, 2.5),
    ]
    assert rows[0].origin != rows[1].origin


def test_two_kinds_of_one_model_are_named_by_their_folders(tmp_path: Path) -> None:
    runs = [
        fake_run(tmp_path / "narrow-0", 0),
        fake_run(tmp_path / "wide-0", 0, width=16),
        fake_run(tmp_path / "wide-1", 1, width=16),
        fake_run(tmp_path / "other", 0, model="physgnn"),
    ]
    names = [row.name for row in run_rows(runs, store=None)]
    assert names == ["narrow", "wide", "wide", "physgnn"]


def test_the_last_run_is_in_the_last_row(tmp_path: Path) -> None:
    runs = [
        fake_run(tmp_path / "a", 0),
        fake_run(tmp_path / "b", 0, model="physgnn"),
        fake_run(tmp_path / "c", 1),
    ]
    rows = run_rows(runs, store=None)
    assert [(row.name, row.seed) for row in rows] == [
        ("physgnn", 0),
        ("lifted", 0),
        ("lifted", 1),
    ]


def test_the_same_seed_twice_is_refused(tmp_path: Path) -> None:
    runs = [fake_run(tmp_path / name, 3) for name in "ab"]
    with pytest.raises(InputError, match=r"differ in their seed \(got \[3, 3\]\)"):
        run_rows(runs, store=None)


def test_seeds_of_different_splits_are_refused(tmp_path: Path) -> None:
    runs = [fake_run(tmp_path / s, i, split=s) for i, s in enumerate("ab")]
    with pytest.raises(InputError, match="different data or splits"):
        run_rows(runs, store=None)


def test_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no finished run"):
        run_rows([tmp_path], store=None)


def test_a_repaired_row_differs_in_name_and_tolerance_alone(tmp_path: Path) -> None:
    (row,) = run_rows([fake_run(tmp_path / "run", 0)], store=None)
    repaired = repaired_row(row, 0.1)
    assert (repaired.name, repaired.tolerance_mm) == ("certified", 0.1)
    assert (repaired.seed, repaired.origin, repaired.make) == (
        row.seed,
        row.origin,
        row.make,
    )


def test_answers_of_another_precision_are_kept_apart(tmp_path: Path) -> None:
    run = fake_run(tmp_path / "run", 0, model="physgnn")
    (exact,), (rough,) = (
        run_rows([run], store=None, precision=precision)
        for precision in ("float32", "bfloat16")
    )
    assert exact.name == rough.name
    assert exact.origin != rough.origin
