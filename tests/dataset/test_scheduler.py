"""A scheduler and workers started separately, as on a cluster, and a worker killed."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physgnn.dataset import Store, generate, verify

NewStore = Callable[..., Store]


def start(program: str, *arguments: object) -> subprocess.Popen[bytes]:
    """Start a Dask program by its module, so that no PATH is needed."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{program}"]
    return subprocess.Popen(
        [*command, *map(str, arguments), "--no-dashboard"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"},
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
