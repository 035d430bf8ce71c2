"""What a killed process leaves running: nothing."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from physgnn.child_processes import CANNOT_RUN, ending_with_us
from physgnn.io.untrusted import reader_process

WAIT_S = 30.0
on_linux = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="only Linux ends children"
)
# What a child does: it says its id, and hangs where Python does not see a signal.
HANG = """
import ctypes, os, pathlib, sys
pathlib.Path(sys.argv[1]).write_text(str(os.getpid()))
ctypes.PyDLL(None).sleep(60)
"""
MESHER = """
import sys
from physgnn.geometry.meshing.mesher_process import run_script
run_script("hang.py", {}, sys.argv[1], timeout_s=60)
"""
PROGRAM = """
import subprocess, sys
from physgnn.child_processes import ending_with_us
subprocess.run(ending_with_us([sys.executable, "hang.py", sys.argv[1]]))
"""
READER = """
import sys
from pathlib import Path
from physgnn.io.untrusted.isolated import IsolatedReader
IsolatedReader("serve.py", "a library").read(Path("hang.py"), note=sys.argv[1])
"""
SERVE = (
    HANG.replace("import ctypes", "def serve(request):\n import ctypes")
    .replace("\npathlib.Path(sys.argv[1])", "\n pathlib.Path(request['note'])")
    .replace("\nctypes", "\n ctypes")
)


@on_linux
@pytest.mark.parametrize("parent", [MESHER, PROGRAM, READER])
def test_a_child_that_hangs_ends_with_a_killed_parent(
    tmp_path: Path, parent: str
) -> None:
    script = parent.replace('"hang.py"', repr(str(tmp_path / "hang.py")), 1)
    (tmp_path / "hang.py").write_text(HANG)
    (tmp_path / "serve.py").write_text(SERVE)
    if parent is MESHER:  # its first argument is its folder
        (tmp_path / "hang.py").write_text(HANG.replace("argv[1]", "argv[2]"))
    named = tmp_path / "named"
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(named)],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    _until(lambda: named.exists() and named.read_text() != "")
    child = psutil.Process(int(named.read_text()))
    time.sleep(0.1)  # into the compiled code
    process.send_signal(signal.SIGKILL)
    process.wait(WAIT_S)
    _, left = psutil.wait_procs([child], timeout=WAIT_S)
    assert not left


@on_linux
def test_a_program_whose_parent_is_gone_already_does_not_start(tmp_path: Path) -> None:
    command = ending_with_us([sys.executable, "-c", "open('here', 'w')"])
    command[command.index(str(os.getpid()))] = "1"
    ended = subprocess.run(command, cwd=tmp_path, check=False)
    assert ended.returncode == CANNOT_RUN
    assert not (tmp_path / "here").exists()


def test_what_a_program_says_and_gives_comes_through() -> None:
    say = "import sys; print(sys.argv[1:], sys.stdin.read()); sys.exit(7)"
    command = ending_with_us([sys.executable, "-c", say, "a b", "--c"])
    ended = subprocess.run(
        command, input="in", capture_output=True, text=True, check=False
    )
    assert (ended.stdout, ended.stderr) == ("['a b', '--c'] in\n", "")
    assert ended.returncode == 7


@on_linux
def test_a_program_that_cannot_be_run_says_so(tmp_path: Path) -> None:
    (tmp_path / "program").write_text("no program")
    (tmp_path / "program").chmod(0o755)
    command = ending_with_us([str(tmp_path / "program")])
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == CANNOT_RUN
    assert ended.stderr == f"{tmp_path / 'program'}: Exec format error\n"


def test_a_reader_serves_more_than_one_request(tmp_path: Path) -> None:
    """It is not ended by the next request, which comes through the same pipe."""
    (tmp_path / "serve.py").write_text("def serve(request):\n    return {}\n")
    requests = f'{{"out": "{tmp_path / "a.npz"}"}}\n' * 3
    ended = subprocess.run(
        [sys.executable, "-P", reader_process.__file__, str(2**33), "serve.py"],
        cwd=tmp_path,
        input=requests,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.stdout == '{"error": ""}\n' * 3
    assert ended.returncode == 0


def _until(reached) -> None:
    end = time.monotonic() + WAIT_S
    while not reached():
        assert time.monotonic() < end
        time.sleep(0.02)
