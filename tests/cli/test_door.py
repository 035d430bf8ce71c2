"""Every way out of a command is one line and an exit code, by real processes."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import psutil
import pytest

from physgnn.geometry.image import Image
from physgnn.io import read_mesh, write_prediction
from physgnn.io.medical.images.formats import write_image

MAIN = "from physgnn.cli import command; command()"
WAIT = 120.0
ENDED = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}


class Started:
    """A command in a process group of its own, as a terminal has it."""

    def __init__(
        self, tmp_path: Path, *arguments: object, program: str = MAIN, **environment
    ) -> None:
        self.temporary = tmp_path / "temporary"
        self.temporary.mkdir()
        self.process = subprocess.Popen(
            [sys.executable, "-c", program, *map(str, arguments)],
            cwd=tmp_path,
            env={**os.environ, "TMPDIR": str(self.temporary), **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def until(self, reached: Callable[[], bool]) -> None:
        """Wait for a moment of the run."""
        end = time.monotonic() + WAIT
        while not reached():
            assert self.process.poll() is None, self.process.communicate()
            assert time.monotonic() < end
            time.sleep(0.005)

    def end(self, number: int, *, everybody: bool = False) -> tuple[int, str]:
        """Send a signal; return exit code and standard error, once all are gone."""
        group = psutil.Process(self.process.pid).children(recursive=True)
        if everybody:
            os.killpg(self.process.pid, number)
        else:
            self.process.send_signal(number)
        _, err = self.process.communicate(timeout=WAIT)
        _, left = psutil.wait_procs(group, timeout=WAIT)
        assert not left
        assert [*self.temporary.iterdir()] == []
        return self.process.returncode, err


def stub(tmp_path: Path, name: str, text: str) -> str:
    """A module that stands in for another; returns what PYTHONPATH must be."""
    folder = tmp_path / "stubs"
    folder.mkdir()
    (folder / f"{name}.py").write_text(textwrap.dedent(text))
    return os.pathsep.join([str(folder), *sys.path])


def test_it_ends_with_what_was_to_be_done_at_the_end_but_without_freeing_all(
    tmp_path: Path,
) -> None:
    program = """
import atexit, pathlib, threading, time, physgnn.cli.app as app
class Kept:
    def __del__(self):
        print("freed")
def end():
    time.sleep(0.5)
    print("thread")
def run():
    app.kept = Kept()
    atexit.register(print, "at exit")
    threading.Thread(target=end).start()
    print("run")
    return 3
app.run = run
from physgnn.cli import command
command()
"""
    process = Started(tmp_path, program=program).process
    assert process.communicate(timeout=WAIT) == ("run\nthread\nat exit\n", "")
    assert process.returncode == 3


@pytest.mark.parametrize("number", ENDED)
def test_a_signal_during_start_up(tmp_path: Path, number: int) -> None:
    slow = stub(
        tmp_path,
        "typer",
        """
        import pathlib, time
        pathlib.Path("here").touch()
        time.sleep(60)
        """,
    )
    started = Started(tmp_path, "--help", PYTHONPATH=slow)
    started.until((tmp_path / "here").exists)
    assert started.end(number) == (128 + number, f"physgnn: {ENDED[number]}\n")


@pytest.mark.parametrize("number", ENDED)
def test_a_signal_that_a_library_turns_into_an_error_of_its_own(
    tmp_path: Path, number: int
) -> None:
    program = """
import pathlib, sys, time, physgnn.cli.app as app
def run():
    try:
        pathlib.Path("here").touch()
        time.sleep(60)
    except BaseException as error:
        raise ImportError("multiarray failed to import") from error
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    started.until((tmp_path / "here").exists)
    assert started.end(number) == (128 + number, f"physgnn: {ENDED[number]}\n")


@pytest.mark.parametrize("number", ENDED)
def test_a_signal_in_a_destructor_is_not_lost(tmp_path: Path, number: int) -> None:
    program = """
import pathlib, time, physgnn.cli.app as app
class Slow:
    def __del__(self):
        pathlib.Path("here").touch()
        time.sleep(5)
def run():
    one = Slow()
    del one
    time.sleep(60)
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    started.until((tmp_path / "here").exists)
    assert started.end(number) == (128 + number, f"physgnn: {ENDED[number]}\n")


@pytest.mark.slow
def test_what_a_signal_cut_short_does_not_complain(tmp_path: Path) -> None:
    """An archive that is half written cannot be closed when it is destroyed."""
    program = """
import pathlib, time, physgnn.cli.app as app
class Archive:
    def __del__(self):
        raise ValueError("seek of closed file")
def run():
    half_written = Archive()
    pathlib.Path("here").touch()
    time.sleep(60)
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    started.until((tmp_path / "here").exists)
    assert started.end(signal.SIGINT) == (130, "physgnn: interrupted\n")


def test_what_is_left_of_shared_memory_is_no_news(tmp_path: Path) -> None:
    """A thread that does not end has the process ended before it has cleaned up."""
    program = """
import multiprocessing, pathlib, threading, time, physgnn.cli.app as app
def run():
    app.kept = multiprocessing.get_context("spawn").Semaphore()
    threading.Thread(target=time.sleep, args=(60,)).start()
    pathlib.Path("here").touch()
    time.sleep(60)
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    started.until((tmp_path / "here").exists)
    assert started.end(signal.SIGTERM) == (143, "physgnn: terminated\n")


def test_ctrl_c_is_for_the_first_of_processes_that_train_together(
    tmp_path: Path,
) -> None:
    """It starts the others such that they ignore it; they keep it so."""
    program = """
import pathlib, signal, time, physgnn.cli.app as app
signal.signal(signal.SIGINT, signal.SIG_IGN)
def run():
    pathlib.Path("here").touch()
    for _ in range(600):
        time.sleep(0.1)
        if pathlib.Path("done").exists():
            return 0
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program, LOCAL_RANK="1")
    started.until((tmp_path / "here").exists)
    started.process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    (tmp_path / "done").touch()
    assert started.process.communicate(timeout=WAIT) == ("", "")
    assert started.process.returncode == 0


@pytest.mark.parametrize("number", ENDED)
def test_a_signal_while_meshing_leaves_no_folder(tmp_path: Path, number: int) -> None:
    out = tmp_path / "mesh.vtu"
    started = Started(tmp_path, "mesh", "--mni152", "--target-points", 60000, "-o", out)
    # not the file by which Python finds out whether the folder can be written to
    started.until(lambda: any(started.temporary.glob("physgnn-*")))
    code, err = started.end(number, everybody=True)
    assert (code, err.splitlines()[-1]) == (128 + number, f"physgnn: {ENDED[number]}")
    assert "Traceback" not in err
    assert not out.exists()


@pytest.mark.slow
@pytest.mark.parametrize("number", ENDED)
def test_a_signal_while_solving(folder: Path, number: int) -> None:
    loads, store = folder / "loads.toml", folder / "loads.zarr"
    many = loads.read_text().replace("paths = 10", "paths = 4000")
    loads.write_text(many.replace("levels = 2", "levels = 20"))
    options = ("--loads", "loads.toml", "--workers", 1, "-o", store)
    started = Started(folder, "simulate", "case.vtu", *options)
    started.until(store.exists)
    time.sleep(1)
    code, err = started.end(number)
    assert (code, err.splitlines()[-1]) == (128 + number, f"physgnn: {ENDED[number]}")
    assert "Traceback" not in err


WRITING = """
import pathlib, time
replace = pathlib.Path.replace
def slow(part, path):
    if pathlib.Path(path).name.startswith("out"):
        pathlib.Path("here").touch()
        time.sleep(60)
    return replace(part, path)
pathlib.Path.replace = slow
from physgnn.cli import command
command()
"""


@pytest.mark.parametrize(
    ("number", "command"),
    [
        (signal.SIGINT, "register case.vtu --points pairs.csv -o out.vtu"),
        (signal.SIGTERM, "warp scan.nii.gz moved.vtu -o out.nii.gz"),
    ],
)
def test_a_signal_while_writing_leaves_nothing(
    folder: Path, number: int, command: str
) -> None:
    mesh = read_mesh(folder / "case.vtu")
    at = mesh.points[mesh.point_set("loaded")]
    pairs = np.hstack([at, at + np.array([0.0, 0.0, -0.01 * np.ptp(mesh.points)])])
    np.savetxt(folder / "pairs.csv", pairs, delimiter=",")
    fields = {"displacement_mm": np.full((mesh.n_points, 3), 0.1)}
    write_prediction(folder / "moved.vtu", mesh, fields, notes={"status": ("ok",)})
    scan = Image(np.ones((8, 8, 8), np.int16), np.diag([10.0, 10.0, 10.0, 1.0]))
    write_image(folder / "scan.nii.gz", scan)
    before = {path.name for path in folder.iterdir()}
    started = Started(folder, *command.split(), program=WRITING)
    started.until((folder / "here").exists)
    code, err = started.end(number)
    assert (code, err.splitlines()[-1]) == (128 + number, f"physgnn: {ENDED[number]}")
    assert "Traceback" not in err
    left = {path.name for path in folder.iterdir()} - before
    assert left == {"here", "temporary"}


def test_children_end_with_the_command(tmp_path: Path) -> None:
    program = """
import pathlib, subprocess, sys, time, physgnn.cli.app as app
def run():
    stubborn = "import signal, time; signal.signal(15, 1); print(); time.sleep(60)"
    child = subprocess.Popen([sys.executable, "-c", stubborn], stdout=subprocess.PIPE)
    child.stdout.readline()
    pathlib.Path("here").touch()
    time.sleep(60)
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    started.until((tmp_path / "here").exists)
    assert started.end(signal.SIGTERM) == (143, "physgnn: terminated\n")


def test_an_error_of_ours_is_one_line_and_a_file(tmp_path: Path) -> None:
    program = """
import physgnn.cli.app as app
def run():
    raise KeyError("one\\ntwo")
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, "a b", program=program)
    out, err = started.process.communicate(timeout=WAIT)
    (report,) = started.temporary.iterdir()
    assert (started.process.returncode, out) == (1, "")
    assert err.count("\n") == 1
    assert str(report) in err
    assert "Traceback" not in err
    text = report.read_text()
    assert "Traceback" in text
    assert "arguments: ['a b']" in text


@pytest.mark.parametrize(
    ("raises", "says"),
    [
        ("OSError(28, 'No space left on device', 'x.vtu')", "x.vtu"),
        ("MemoryError('Unable to allocate 9 TiB')", "not enough memory"),
        ("PermissionError(13, 'Permission denied', 'x')", "Permission denied: x"),
    ],
)
def test_what_the_machine_refuses_is_one_line(
    tmp_path: Path, raises: str, says: str
) -> None:
    program = f"""
import physgnn.cli.app as app
def run():
    raise {raises}
app.run = run
from physgnn.cli import command
command()
"""
    started = Started(tmp_path, program=program)
    _, err = started.process.communicate(timeout=WAIT)
    assert started.process.returncode == 2
    assert says in err
    assert err.count("\n") == 1


def test_a_reader_that_leaves_is_no_news() -> None:
    command = f"{sys.executable} -c '{MAIN}' --help | true; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=WAIT
    )
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("frobnicate",), "No such command 'frobnicate' (see physgnn --help)"),
        (("predict",), "Missing option '--load' (see physgnn predict --help)"),
        (("predict", "--nonsense"), "No such option: --nonsense"),
        (
            ("simulate", "x", "--workers", "none", "-o", "y"),
            "Input should be a valid integer",
        ),
        (("mesh", "-o", "y", "--quality-floor"), "requires an argument"),
        (
            ("simulate", "x", "-o", "y", "--preset", "no"),
            "'no' is not one of 'paper-1'",
        ),
    ],
)
def test_wrong_arguments_are_one_line(
    tmp_path: Path, arguments: tuple[str, ...], says: str
) -> None:
    started = Started(tmp_path, *arguments)
    out, err = started.process.communicate(timeout=WAIT)
    assert (started.process.returncode, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


def test_help_goes_to_standard_output(tmp_path: Path) -> None:
    started = Started(tmp_path)
    out, err = started.process.communicate(timeout=WAIT)
    assert (started.process.returncode, err) == (0, "")
    assert "Commands:" in out
