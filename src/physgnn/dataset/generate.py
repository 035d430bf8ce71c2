"""Solve the pending load paths of a store, here or on many machines.

Every worker opens the store, builds one solver, and writes the paths it is given into
their own chunks. A path is solved again only if it was not finished, so a run may be
killed at any moment and started again.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache, partial
from threading import Lock
from typing import Any

from physgnn.dataset import cluster
from physgnn.dataset.store import Store
from physgnn.errors import InputError
from physgnn.mechanics.solver import Solver
from physgnn.progress import Progress

ALREADY_THERE = "already there"
_one_at_a_time = Lock()  # the solver is one worker's, and a worker may have threads


@dataclass(frozen=True)
class Generation:
    """What a run did.

    Attributes
    ----------
    solved : int
        Paths written in this run.
    errors : dict of int to str
        Paths that raised an error and are still pending, and what it said.
    """

    solved: int = 0
    errors: dict[int, str] = field(default_factory=dict)


def generate(
    store: Store,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Generation:
    """Solve and write every pending path.

    Parameters
    ----------
    store : Store
        Results go into it.
    workers : int
        Processes on this machine, each with one thread; 1 works in this process.
    scheduler : str, optional
        Address of a Dask scheduler (``tcp://…``) whose workers see the store under the
        same absolute path; `workers` is then ignored.
    progress : callable, optional
        Told the paths done, the paths in all, and how the last one ended.

    Returns
    -------
    Generation
        A path that reaches no equilibrium is written with the status that says why. One
        that raises an error does not stop the others, and stays pending.

    Raises
    ------
    InputError
        If `workers` is less than 1 or the scheduler does not answer.
    """
    if workers < 1:
        raise InputError(f"workers must be 1 or more (got {workers})")
    pending = store.pending().tolist()
    workers = min(workers, len(pending))
    if workers == 0:
        return Generation()
    if workers == 1 and scheduler is None:
        solver = Solver(store.mesh, store.materials, store.fixed)
        results = (solve_and_write(store, solver, i) for i in pending)
        return _gather(results, store, progress)
    with cluster.connect(workers, scheduler) as client:
        return _gather(_submit(client, store, pending), store, progress)


Result = tuple[int, str, str]  # path, how it ended, error if it raised one


def solve_and_write(store: Store, solver: Solver, i: int) -> Result:
    """Solve path `i` and write it, unless somebody has."""
    if not store.is_pending(i):
        return i, ALREADY_THERE, ""
    try:
        solution = solver.solve(store.load_path(i))
        store.write(i, solution)
    except Exception as error:  # whatever it was, the other paths can be solved
        return i, "error", f"{type(error).__name__}: {error}"
    return i, solution.message or "converged", ""


def _work(store_path: str, definition: str, i: int) -> Result:
    """Solve path `i` in a worker process."""
    with _one_at_a_time:
        return solve_and_write(*_equipment(store_path, definition), i)


@lru_cache(maxsize=1)
def _equipment(store_path: str, definition: str) -> tuple[Store, Solver]:
    """Return a worker's store and solver, built when it first needs them.

    A worker may outlive the store, so what the store asks is part of the key.
    """
    store = Store.open(store_path)
    if store.definition_hash != definition:
        raise InputError(f"store {store_path} is not the one the run was started with")
    return store, Solver(store.mesh, store.materials, store.fixed)


def _gather(
    results: Iterator[Result], store: Store, progress: Progress | None
) -> Generation:
    solved, errors = 0, {}
    done = store.n_paths - len(store.pending())
    for i, ended, error in results:
        done += 1
        solved += not error and ended != ALREADY_THERE
        if error:
            errors[i] = error
        if progress:
            progress(done, store.n_paths, f"load path {i}: {ended}")
    return Generation(solved, errors)


def _submit(client: Any, store: Store, pending: list[int]) -> Iterator[Result]:
    """Yield results as they come; a path whose worker dies goes to another one."""
    from distributed import as_completed

    work = partial(_work, str(store.path.resolve()), store.definition_hash)
    futures = client.map(work, pending, pure=False)
    index = dict(zip((future.key for future in futures), pending, strict=True))
    for future in as_completed(futures):
        error = future.exception()  # of the cluster: a path's own are caught
        i = index[future.key]
        yield (i, "error", str(error)) if error else future.result()
