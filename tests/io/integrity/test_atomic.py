from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from physgnn.errors import InputError
from physgnn.io.integrity.atomic import whole_file, whole_folder, write_whole


def test_success_replaces_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with whole_file(path) as part:
        part.write_text("new")
        assert path.read_text() == "old"
        assert part.suffix == ".txt"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_failure_keeps_the_old_file_and_leaves_nothing(
    tmp_path: Path, error: type[BaseException]
) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(error), whole_file(path) as part:
        part.write_text("half")
        raise error
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_folder_is_said_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not there"), whole_file(tmp_path / "x/a"):
        pytest.fail("must not be entered")


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\r")))
def test_text_is_read_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, text: str
) -> None:
    path = tmp_path_factory.mktemp("text") / "a.txt"
    write_whole(path, text)
    assert path.read_text("utf-8") == text


def test_a_folder_appears_when_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "new" / "run"
    with whole_folder(path) as part:
        part.mkdir()
        (part / "a.txt").write_text("whole")
        assert not path.exists()
    assert (path / "a.txt").read_text() == "whole"
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_half_a_folder_is_taken_away(
    tmp_path: Path, error: type[BaseException]
) -> None:
    with pytest.raises(error), whole_folder(tmp_path / "run") as part:
        part.mkdir()
        (part / "a.txt").write_text("half")
        raise error
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_there_is_never_replaced(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match="exists already"),
        whole_folder(tmp_path),
    ):
        pytest.fail("must not be entered")
