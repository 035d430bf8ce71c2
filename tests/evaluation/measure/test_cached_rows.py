"""A measured row is found again, and only for the question it answers."""

from dataclasses import replace
from pathlib import Path

import pytest

from physgnn.dataset.storage.store import Store
from physgnn.evaluation.measure.baselines import baseline_rows
from physgnn.evaluation.measure.cached_rows import CachedRows
from physgnn.evaluation.measure.held_out import HeldOut
from physgnn.evaluation.measure.measuring import evaluate
from physgnn.evaluation.measure.rows import Row


@pytest.fixture
def held_out(store: Store) -> HeldOut:
    return HeldOut(store, "some", store.samples()[:3], store.samples()[3:7])


def forbidden() -> None:
    raise AssertionError("made again")


def test_what_was_measured_is_not_made_again(tmp_path: Path, held_out: HeldOut) -> None:
    cached = CachedRows(tmp_path / "rows", held_out)
    (row,) = baseline_rows(["linear"], held_out)
    first = evaluate([row], held_out, cached=cached)
    again = evaluate([Row("linear", forbidden)], held_out, cached=cached)
    assert again == first


@pytest.mark.parametrize(
    "change", [{"seed": 1}, {"origin": "other weights"}, {"tolerance_mm": 0.1}]
)
def test_another_question_has_no_answer(
    tmp_path: Path, held_out: HeldOut, change: dict
) -> None:
    cached = CachedRows(tmp_path, held_out)
    (row,) = baseline_rows(["zero"], held_out)
    evaluate([row], held_out, cached=cached)
    assert cached.get(row) is not None
    assert cached.get(replace(row, **change)) is None


def test_other_samples_have_no_answer(tmp_path: Path, held_out: HeldOut) -> None:
    (row,) = baseline_rows(["zero"], held_out)
    evaluate([row], held_out, cached=CachedRows(tmp_path, held_out))
    for part in ("train", "test"):
        fewer = replace(held_out, **{part: getattr(held_out, part)[1:]})
        assert CachedRows(tmp_path, fewer).get(row) is None
