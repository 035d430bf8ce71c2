"""Generation resumes after any end, does nothing twice, and answers alike anywhere."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from multiprocessing import active_children
from typing import Any

import numpy as np
import pytest

from meshes import block_mesh
from physgnn.dataset import Store, generate
from physgnn.dataset.generation.abreast import NAME
from physgnn.dataset.generation.pending_paths import (
    SOLVE,
    paths_abreast,
    solve_and_write,
)
from physgnn.errors import InputError
from physgnn.geometry.tetmesh import TetMesh
from physgnn.mechanics.equilibrium.solution import Status
from physgnn.mechanics.equilibrium.solver import Solver

NewStore = Callable[..., Store]

SLOWLY = """
import sys, time
from physgnn.dataset import Store, generate
slowly = lambda done, *_: time.sleep(0.2 if done < 7 else 600)
generate(Store.open(sys.argv[1]), progress=slowly)
"""


def modified(store: Store) -> dict[str, int]:
    folder = store.path / "result"
    return {str(f): f.stat().st_mtime_ns for f in folder.rglob("c/*") if f.is_file()}


def test_every_path_is_solved_and_told(new_store: NewStore) -> None:
    store, told = new_store(), []
    result = generate(store, progress=lambda *step: told.append(step))
    assert (result.solved, result.errors) == (5, {})
    assert store.pending().tolist() == []
    assert (store.status == 0).all()
    assert (store.residual < 1e-3).all()
    assert [step[:2] for step in told] == [(n, 5) for n in range(1, 6)]
    assert told[-1][2] == "load path 4: converged"
    alone = Solver(store.body).solve(store.load_path(3))
    assert np.array_equal(store.displacement(3), alone.displacement.astype("f4"))


def test_a_second_run_changes_nothing(new_store: NewStore) -> None:
    store = new_store()
    generate(store)
    before = modified(store)
    assert generate(store, workers=2).solved == 0
    assert modified(store) == before


def test_killed_and_resumed(new_store: NewStore) -> None:
    """Kill -9 in the middle: what is done stays, the rest follows, nothing differs."""
    store, whole = new_store("killed", 8), new_store("whole", 8)
    run = subprocess.Popen([sys.executable, "-c", SLOWLY, str(store.path)])
    while len(store.pending()) > 5:
        assert run.poll() is None
        time.sleep(0.02)
    os.kill(run.pid, signal.SIGKILL)
    run.wait()
    left = len(store.pending())
    assert 0 < left <= 5
    kept = modified(store)
    assert generate(store).solved == left
    after = modified(store)
    finished = [f for f in kept if "status" in f]
    assert {f: after[f] for f in finished} == {f: kept[f] for f in finished}
    generate(whole)
    assert store.content_hash() == whole.content_hash()


def test_one_bad_path_does_not_stop_the_others(
    new_store: NewStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, solve = new_store(), Solver.solve

    def fail_on_the_third(solver: Solver, path: Any) -> Any:
        if path.forces[0, 2] == store.load_path(2).forces[0, 2]:
            raise MemoryError("no room")
        return solve(solver, path)

    monkeypatch.setattr(Solver, "solve", fail_on_the_third)
    result = generate(store)
    assert result.solved == 4
    assert result.errors == {2: "MemoryError: no room"}
    assert store.pending().tolist() == [2]
    monkeypatch.undo()
    assert generate(store).solved == 1


def test_an_impossible_load_is_recorded(new_store: NewStore) -> None:
    store = new_store(force_n=10.0, n_paths=2)
    result = generate(store)
    assert (result.solved, result.errors) == (2, {})
    assert (store.status[:, -1] != Status.CONVERGED).all()
    assert (store.status != Status.NOT_SOLVED).all()
    assert store.message(1).startswith("stopped at load factor")
    assert (store.reached < 1).all()


def test_somebody_elses_path_is_left_alone(new_store: NewStore) -> None:
    store = new_store()
    generate(store)
    solver = Solver(store.body)
    assert solve_and_write(store, solver, 1) == ("already there", "")


def test_two_processes_one_of_them_killed(new_store: NewStore) -> None:
    """A dead worker's path goes to another; the displacement is the same."""
    store, whole = new_store("two", 24), new_store("one", 24)
    killed: list[int] = []
    others = {*active_children()}  # that other tests left alive

    def kill_one(*step: Any) -> None:
        if step[0] == 4:
            killed.append(({*active_children()} - others).pop().pid or 0)
            os.kill(killed[0], signal.SIGKILL)

    result = generate(store, workers=2, progress=kill_one)
    generate(whole)
    assert killed
    assert result.errors == {}
    assert store.pending().tolist() == []
    assert store.content_hash() == whole.content_hash()


SIDE_BY_SIDE = """
import sys
from physgnn.dataset import Store, generate
if __name__ == "__main__":
    generate(Store.open(sys.argv[1]), workers=int(sys.argv[2]))
"""


@pytest.fixture(scope="module")
def larger() -> TetMesh:
    """Return a mesh whose paths are solved side by side."""
    return block_mesh(15, jitter=0.2)


@pytest.mark.parametrize("workers", [1, 2])
def test_side_by_side_killed_and_resumed(
    new_store: NewStore, larger: TetMesh, workers: int
) -> None:
    """In whatever company a path is solved, its displacement has the same bits."""
    killed, whole, one = (
        new_store(name, 10, mesh=larger, force_n=1e-4)
        for name in ("killed", "whole", "one")
    )
    assert paths_abreast(killed) > 1
    command = [sys.executable, "-c", SIDE_BY_SIDE, str(killed.path), str(workers)]
    run = subprocess.Popen(command)
    while len(killed.pending()) == 10:
        assert run.poll() is None
        time.sleep(0.02)
    os.kill(run.pid, signal.SIGKILL)
    run.wait()
    done = np.setdiff1d(np.arange(10), killed.pending())
    kept = [killed.displacement(i) for i in done]
    assert generate(killed).solved <= 10 - len(done)
    for i, before in zip(done, kept, strict=True):
        assert np.array_equal(killed.displacement(i), before)
    assert generate(whole, workers=3 - workers).solved == 10
    assert killed.content_hash() == whole.content_hash()
    assert solve_and_write(one, SOLVE.prepare(one), 5) == ("converged", "")
    assert np.array_equal(one.displacement(5), whole.displacement(5))


def test_side_by_side_left_early(new_store: NewStore, larger: TetMesh) -> None:
    """What stops a run stops the paths that are being solved, too."""
    store = new_store(n_paths=10, mesh=larger, force_n=1e-4)

    def refuse(*_: Any) -> None:
        raise InputError("enough")

    with pytest.raises(InputError, match="enough"):
        generate(store, progress=refuse)
    assert 0 < len(store.pending()) < 10
    assert not any(NAME in thread.name for thread in threading.enumerate())
    assert generate(store).solved > 0
    assert (store.status == Status.CONVERGED).all()


def test_refusals(new_store: NewStore) -> None:
    store = new_store()
    with pytest.raises(InputError, match="workers must be 1 or more"):
        generate(store, workers=0)


def test_no_scheduler(new_store: NewStore, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("physgnn.dataset.generation.cluster.TIMEOUT_SECONDS", 0.5)
    with pytest.raises(InputError, match="no Dask scheduler answers at tcp://"):
        generate(new_store(), scheduler="tcp://127.0.0.1:9")


LITTLE_ROOM = """
import resource, sys
from physgnn.dataset import Store, generate
from physgnn.errors import InputError
store = Store.open(sys.argv[1])
generate(store, progress=lambda done, *_: done == 2 and resource.setrlimit(
    resource.RLIMIT_FSIZE, (1000, 1000)))
"""


def test_a_full_disk_stops_the_run(new_store: NewStore) -> None:
    """What is done stays, nothing is half-written, and the next run goes on."""
    store, whole = new_store(), new_store("whole")
    run = subprocess.run(
        [sys.executable, "-c", LITTLE_ROOM, str(store.path)],
        capture_output=True,
        text=True,
        check=False,
    )
    said = run.stderr.splitlines()[-1]
    assert "InputError: store" in said
    assert "run the same command again: it goes on from here" in said
    assert store.pending().tolist() == [2, 3, 4]
    generate(store)
    generate(whole)
    assert store.content_hash() == whole.content_hash()
