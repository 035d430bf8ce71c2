"""Worker processes: deaths, errors, and no process or open port left behind."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from multiprocessing import active_children
from pathlib import Path

import pytest

from physgnn.dataset.generation.processes import MOST_DEATHS, spread
from physgnn.errors import InputError
from worker_tasks import deadly, fails, named, refuses

ENDLESS = """
import sys, time
from physgnn.dataset.generation.processes import spread
if __name__ == "__main__":
    print("started", flush=True)
    for _ in spread(time.sleep, [600, 600], 2):
        pass
"""


OTHERS: set[object] = set()  # processes that other tests left alive


@pytest.fixture(autouse=True)
def _others() -> None:
    OTHERS.clear()
    OTHERS.update(active_children())


def new_children() -> set[object]:
    return {*active_children()} - OTHERS


def test_every_path_is_done_once() -> None:
    found = sorted(spread(named, list(range(7)), 2))
    assert found == [(i, f"path {i} by 1 thread", "") for i in range(7)]
    assert new_children() == set()


def test_a_path_whose_process_dies_is_done_by_another(tmp_path: Path) -> None:
    do = partial(deadly, tmp_path, 1)
    found = {i: ended for i, ended, _ in spread(do, [0, 1, 2], 2)}
    assert found == {0: "done", 1: "done", 2: "done"}
    assert len(list(tmp_path.glob("1-*"))) == 2


def test_a_path_that_always_kills_is_given_up(tmp_path: Path) -> None:
    do = partial(deadly, tmp_path, 99)
    found = {i: error for i, _, error in spread(do, [0, 1, 2], 2)}
    assert found == {0: "", 1: f"its process died {MOST_DEATHS} times", 2: ""}


def test_paths_side_by_side() -> None:
    found = sorted(spread(named, list(range(9)), 2, most=3))
    assert found == [(i, f"path {i} by 1 thread", "") for i in range(9)]
    assert new_children() == set()


@pytest.mark.parametrize("worst", [1, 99])
def test_others_that_die_with_a_path_are_done(worst: int, tmp_path: Path) -> None:
    """The next time each of them is alone, so that only the deadly one is given up."""
    do = partial(deadly, tmp_path, worst)
    found = {i: error for i, _, error in spread(do, list(range(6)), 1, most=4)}
    given_up = f"its process died {MOST_DEATHS} times" if worst > 1 else ""
    assert found == {i: given_up if i == 1 else "" for i in range(6)}
    deaths = min(worst, MOST_DEATHS)
    assert len(list(tmp_path.glob("1-*"))) == deaths + (worst == 1)


def test_errors_are_named() -> None:
    with pytest.raises(InputError, match="no solver here"):
        list(spread(refuses, [0, 1], 2))
    assert new_children() == set()
    assert list(spread(fails, [4], 1)) == [(4, "error", "RuntimeError: a bug")]


def test_left_early() -> None:
    results = spread(named, list(range(100)), 2)
    next(results)
    results.close()  # type: ignore[attr-defined]
    assert new_children() == set()


@pytest.mark.parametrize(
    ("end", "wait"),
    [("SIGKILL", 1.0), ("SIGTERM", 1.0), ("SIGINT", 1.0), ("SIGINT", 0.0)],
)
def test_workers_end_with_their_parent(end: str, wait: float, tmp_path: Path) -> None:
    """Whatever ends it, and while it starts: no process stays, none prints."""
    script = tmp_path / "endless.py"
    script.write_text(ENDLESS)
    run = subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert run.stdout is not None
    assert run.stdout.readline() == "started\n"
    time.sleep(wait)
    # Ctrl-C in a terminal reaches every process of the group
    (os.killpg if end == "SIGINT" else os.kill)(run.pid, getattr(signal, end))
    _, said = run.communicate(timeout=120)  # ends once the last holder of stderr has
    assert said.count("Traceback") == (end == "SIGINT")  # the parent's own


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="Linux tells the ports")
def test_no_port_is_opened() -> None:
    before = listening()
    results = spread(named, list(range(20)), 2)
    next(results)
    assert listening() <= before
    results.close()  # type: ignore[attr-defined]


def listening() -> set[str]:
    """Return the sockets on which processes that we started listen."""
    inodes = {
        line.split()[9]
        for name in ("tcp", "tcp6")
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]
        if line.split()[3] == "0A"
    }
    ours = set()
    for process in (os.getpid(), *(child.pid for child in active_children())):
        for link in Path(f"/proc/{process}/fd").iterdir():
            try:
                ours.add(str(link.readlink()).removeprefix("socket:[").rstrip("]"))
            except OSError:
                continue
    return inodes & ours
