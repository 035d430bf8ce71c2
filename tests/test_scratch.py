"""What a killed process left is gone after the next start, and only that."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from physgnn.scratch import MACHINE, began, clear, is_alive, prefix

HOLDER = """
import time
from physgnn.scratch import scratch_folder
with scratch_folder("test") as folder:
    print(folder, flush=True)
    time.sleep(60)
"""
COMMAND = "from physgnn.cli import main; main()"


def holder(temporary: Path) -> tuple[subprocess.Popen[str], Path]:
    """A process that has a temporary folder, and the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(temporary)},
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def test_the_next_command_removes_what_a_killed_one_left(tmp_path: Path) -> None:
    killed, left = holder(tmp_path)
    alive, kept = holder(tmp_path)
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    (left / "surface.npz").touch()
    try:
        done = subprocess.run(
            [sys.executable, "-c", COMMAND, "--help"],
            env={**os.environ, "TMPDIR": str(tmp_path)},
            capture_output=True,
            check=True,
        )
        assert not done.stderr
        assert [*tmp_path.iterdir()] == [kept]
    finally:
        alive.kill()
        alive.communicate()


def test_a_signal_before_anyone_holds_the_folder_leaves_none(tmp_path: Path) -> None:
    program = """
import tempfile, physgnn.scratch
def cut_short(self, *_, **options):
    print(tempfile.mkdtemp(prefix=options["prefix"]))
    raise SystemExit(130)
tempfile.TemporaryDirectory.__init__ = cut_short
physgnn.scratch.scratch_folder("test")
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "TMPDIR": str(tmp_path)},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 130
    assert str(tmp_path) in done.stdout.decode()
    assert [*tmp_path.iterdir()] == []


def test_a_folder_in_use_of_others_or_of_another_machine_stays(tmp_path: Path) -> None:
    mine, start = os.getpid(), began(os.getpid())
    stays = [
        f"{prefix('mesher')}abc",
        f"physgnn-mesher-{'0' * 8}-999999999-1-abc",  # another machine's
        f"physgnn-error-{MACHINE}.txt",
        "physgnn-mesher-abc",
        f"physgnn-mesher-{MACHINE}-{mine}-{start}-",
    ]
    goes = [
        f"physgnn-read-{MACHINE}-999999999-1-abc",
        f"physgnn-read-{MACHINE}-{10**30}-1-abc",
        f"physgnn-read-{MACHINE}-{mine}-{(start or 0) + 1}-abc",  # its id came again
    ]
    for name in (*stays, *goes):
        (tmp_path / name / "in").mkdir(parents=True)
    clear(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == set(stays)


def test_a_link_of_such_a_name_leads_nowhere(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    link = tmp_path / f"physgnn-read-{MACHINE}-999999999-1-abc"
    link.symlink_to(tmp_path / "kept")
    clear(tmp_path)
    assert (tmp_path / "kept").is_dir()
    clear(tmp_path / "absent")


def test_a_process_is_known_by_when_it_began() -> None:
    mine = os.getpid()
    assert is_alive(mine)
    assert is_alive(mine, began(mine))
    assert not is_alive(mine, (began(mine) or 0) + 1)
    assert began(999_999_999) is None


def test_without_proc_the_clock_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(*_: object, **__: object) -> str:
        raise FileNotFoundError

    monkeypatch.setattr(Path, "read_text", absent)
    start = began(os.getpid())
    assert start is not None
    assert 0 < start <= time.time()
    assert began(999_999_999) is None
    assert began(10**30) is None
