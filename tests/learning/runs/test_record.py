"""Where a run finds the dataset it was trained on."""

from pathlib import Path

import pytest

from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.runs.record import place_of_store, with_places


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return tmp_path / "runs" / "one"


def record_of(
    run: Path, store: Store, monkeypatch: pytest.MonkeyPatch
) -> dict[str, object]:
    """A record made by a command that named the dataset from its own folder."""
    monkeypatch.chdir(store.path.parent)
    relative = Store.open(store.path.name)
    data = {"data": {"path": store.path.name}}
    return with_places(data, run, [relative])


def test_it_is_found_from_any_folder_and_moves_with_the_run(
    run: Path,
    store: Store,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    record = record_of(run, store, monkeypatch)
    run.mkdir(parents=True)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    assert place_of_store(run, record).samefile(store.path)
    moved = elsewhere / "far" / "away" / "run"  # the run alone: its place in full holds
    moved.mkdir(parents=True)
    assert place_of_store(moved, record).samefile(store.path)
    both = elsewhere / "runs" / "one"  # both together: its place from the run holds
    both.mkdir(parents=True)
    store.path.rename(elsewhere / store.path.name)
    assert place_of_store(both, record).samefile(elsewhere / store.path.name)


def test_an_old_record_is_read_as_before_and_what_is_lost_is_named(
    run: Path, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = {"data": {"path": store.path.name}}
    monkeypatch.chdir(store.path.parent)
    assert place_of_store(run, old).samefile(store.path)
    monkeypatch.chdir("/")
    with pytest.raises(InputError, match="--store"):
        place_of_store(run, old)
