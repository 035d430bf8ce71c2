"""What a killed process left is removed by whoever writes there next, and only that."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from physgnn.io.integrity.atomic import whole_folder, write_whole
from physgnn.io.integrity.strays import (
    MACHINE,
    PARTIAL_SECONDS,
    beside,
    clear_partial_chunks,
    clear_strays,
)

DEAD = 999_999_999  # beyond every system's process ids
WRITER = """
import sys, time
from pathlib import Path
from physgnn.cli import app, door
from physgnn.io.integrity.atomic import whole_file, whole_folder

def run():
    path = Path(sys.argv[1])
    if path.suffix:
        with whole_file(path) as part:
            part.write_text("half")
            print("writing", flush=True)
            time.sleep(60)
    with whole_folder(path) as part:
        part.mkdir()
        (part / "half").write_text("half")
        print("writing", flush=True)
        time.sleep(60)

app.run = run
door.main()
"""


def stopped_while_writing(path: Path, number: int) -> tuple[int, str]:
    """Stop a command by a signal while it writes; return exit code and what it said."""
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "writing\n"
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    return process.returncode, said


@pytest.mark.parametrize("name", ["a.txt", "folder"])
@pytest.mark.parametrize(
    ("number", "code", "said"),
    [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")],
)
def test_a_signal_while_writing_leaves_nothing(
    tmp_path: Path, name: str, number: int, code: int, said: str
) -> None:
    if name == "a.txt":
        (tmp_path / name).write_text("old")
    before = {file.name for file in tmp_path.iterdir()}
    assert stopped_while_writing(tmp_path / name, number) == (
        code,
        f"physgnn: {said}\n",
    )
    assert {file.name for file in tmp_path.iterdir()} == before
    assert name == "folder" or (tmp_path / name).read_text() == "old"


@pytest.mark.parametrize("name", ["a.txt", "folder"])
def test_what_a_kill_while_writing_left_goes_with_the_next_writing(
    tmp_path: Path, name: str
) -> None:
    path = tmp_path / name
    code, _ = stopped_while_writing(path, signal.SIGKILL)
    assert code == -signal.SIGKILL
    assert len([*tmp_path.iterdir()]) == 1
    if path.suffix:
        write_whole(path, "new")
    else:
        with whole_folder(path) as part:
            part.mkdir()
    assert [*tmp_path.iterdir()] == [path]


def test_only_strays_of_dead_processes_of_this_machine_go(tmp_path: Path) -> None:
    stray = [f".{DEAD}@{MACHINE}.run.json", f".{DEAD}.run.json"]
    left = [
        f".{os.getpid()}.run.json",
        beside(tmp_path / "run.json").name,
        f".{DEAD}@{'0' * 8}.run.json",  # another machine's
        f"{DEAD}.run.json",
        f".{DEAD}",
        ".hidden",
    ]
    for name in (*stray, *left):
        (tmp_path / name).write_text("")
    (tmp_path / f".{DEAD}.folder" / "in").mkdir(parents=True)
    clear_strays(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == set(left)


def test_only_strays_of_the_same_name_go(tmp_path: Path) -> None:
    for name in ("a.txt", "b.txt"):
        (tmp_path / f".{DEAD}.{name}").write_text("half")
    write_whole(tmp_path / "a.txt", "whole")
    assert {file.name for file in tmp_path.iterdir()} == {"a.txt", f".{DEAD}.b.txt"}


def test_chunks_that_zarr_left_unfinished_go_once_they_are_old(tmp_path: Path) -> None:
    row = tmp_path / "result" / "status" / "c" / "0"
    row.mkdir(parents=True)
    old, new, whole = row / "0.ab.partial", row / "0.cd.partial", row / "0"
    for file in (old, new, whole):
        file.write_text("")
    long_ago = time.time() - 2 * PARTIAL_SECONDS
    for file in (old, whole):
        os.utime(file, (long_ago, long_ago))
    clear_partial_chunks(tmp_path)
    assert {*row.iterdir()} == {new, whole}
