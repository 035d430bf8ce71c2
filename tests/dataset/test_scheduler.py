"""Schedulers and workers started separately, as on a cluster: killed, and secured."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from documented_pages import DOCS, blocks
from physgnn.dataset import Store, generate, verify
from physgnn.dataset.generation.cluster import spread

NewStore = Callable[..., Store]
ONE_THREAD = {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def start(
    program: str, *arguments: object, **environment: str
) -> subprocess.Popen[bytes]:
    """Start a Dask program by its module, so that no PATH is needed."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{program}"]
    return subprocess.Popen(
        [*command, *map(str, arguments), "--no-dashboard"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **ONE_THREAD, **environment},
    )


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler's address, and two worker processes of one thread each."""
    file = tmp_path / "scheduler.json"
    scheduler = start("scheduler", "--port", 0, "--scheduler-file", file)
    workers = []
    try:
        wait_for(file.is_file)
        for i in range(2):
            folder = tmp_path / f"worker-{i}"
            options = ("--nthreads", 1, "--no-nanny", "--local-directory", folder)
            workers.append(start("worker", "--scheduler-file", file, *options))
        yield json.loads(file.read_text())["address"], workers
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def wait_for(happened: Callable[[], Any], seconds: float = 60) -> None:
    deadline = time.monotonic() + seconds
    while not happened():
        assert time.monotonic() < deadline, "the cluster did not start"
        time.sleep(0.05)


def writes(store: Store) -> dict[str, int]:
    """Return when every path's status, its last row, was written."""
    folder = store.path / "result" / "status"
    return {str(f): f.stat().st_mtime_ns for f in folder.rglob("c/*/0")}


@pytest.mark.slow
def test_one_of_two_workers_killed(
    new_store: NewStore, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    """Nothing is lost, nothing done twice, and the store is that of one process."""
    store, alone = new_store("cluster", 40), new_store("alone", 40)
    address, workers = cluster
    kept: dict[str, int] = {}
    told: list[str] = []

    def kill_one(done: int, _: int, text: str) -> None:
        told.append(text.split(":")[0])
        if done == 6:
            workers[0].send_signal(signal.SIGKILL)
            workers[0].wait()
            kept.update(writes(store))

    result = generate(store, scheduler=address, progress=kill_one)
    assert workers[0].returncode == -signal.SIGKILL
    assert workers[1].poll() is None
    assert result.errors == {}
    assert store.pending().tolist() == []
    assert sorted(told) == sorted(f"load path {i}" for i in range(40))
    after = writes(store)
    assert len(kept) >= 6
    assert {file: after[file] for file in kept} == kept

    generate(alone)
    assert store.content_hash() == alone.content_hash()
    for i in range(40):
        assert np.array_equal(store.displacement(i), alone.displacement(i))
    assert verify(store, scheduler=address).largest_mm < 1e-4


@pytest.mark.slow
def test_some_paths_at_once(
    cluster: tuple[str, list[subprocess.Popen[bytes]]],
) -> None:
    """Every path is told of once, however many a worker does side by side."""
    do, paths = partial(divmod, 100), list(range(1, 24))
    for most in (1, 4):
        found = sorted(spread(do, paths, cluster[0], most=most))  # type: ignore[arg-type]
        assert found == [(i, *divmod(100, i)) for i in paths]


SOLVE = """
import sys
from physgnn.dataset import Store, generate
from physgnn.errors import InputError
try:
    result = generate(Store.open(sys.argv[1]), scheduler=sys.argv[2])
except InputError as error:
    sys.exit(str(error))
sys.exit(bool(result.errors))
"""


def solve(store: Store, address: str, environment: dict[str, str]) -> tuple[int, str]:
    """Solve in a process of its own: Dask reads the environment when it is imported."""
    done = subprocess.run(
        [sys.executable, "-c", SOLVE, str(store.path), address],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=300,
    )
    return done.returncode, done.stderr


def environment_of_the_page(folder: Path) -> tuple[dict[str, str], list[str]]:
    """Run what the page says of TLS; return what it exports, and its last command."""
    page = blocks(DOCS / "howto" / "cluster.md")
    (block,) = [block for block in page if "openssl req" in block.text]
    *setting, last = block.text.strip().splitlines()
    script = "\n".join(["set -e", *setting, "env -0"])
    said = subprocess.run(
        ["bash", "-c", script], cwd=folder, capture_output=True, check=True
    )
    pairs = (line.split("=", 1) for line in said.stdout.decode().split("\0") if line)
    found = {name: value for name, value in pairs if name.startswith("DASK_")}
    return found, last.split()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")
def test_the_recipe_for_tls(new_store: NewStore, tmp_path: Path) -> None:
    """With the key the store is filled; who has none reaches nothing."""
    environment, last = environment_of_the_page(tmp_path)
    assert last == ["dask", "scheduler", "--protocol", "tls", "--no-dashboard"]
    assert (tmp_path / "key.pem").stat().st_mode & 0o077 == 0
    file, store = tmp_path / "scheduler.json", new_store("secured", 2)
    options = ("--protocol", "tls", "--port", 0, "--scheduler-file", file)
    started = [start("scheduler", *options, **environment)]
    try:
        wait_for(file.is_file)
        address = json.loads(file.read_text())["address"]
        assert address.startswith("tls://")
        options = ("--nthreads", 1, "--no-nanny", "--local-directory", tmp_path / "w")
        started.append(start("worker", address, *options, **environment))
        for stranger in (address, address.replace("tls://", "tcp://")):
            code, said = solve(store, stranger, {})
            assert code == 1
            assert f"no Dask scheduler answers at {stranger}" in said
        assert len(store.pending()) == 2
        assert solve(store, address, environment) == (0, "")
    finally:
        for process in started:
            process.kill()
            process.wait()
    assert len(store.pending()) == 0
