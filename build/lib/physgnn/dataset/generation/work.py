"""Work on load paths one by one: in this process, or in many.

Every process opens the store, prepares what the work needs once (a solver, say), and
does the paths it is given. A path whose worker dies goes to another one.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import lru_cache, partial
from threading import Lock
from typing import Any

from physgnn.dataset.generation import cluster, processes
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError

Result = tuple[int, str, str]
"""Load path, how it ended, and the error if it raised one."""

_one_at_a_time = Lock()  # tools are one worker's, and a worker may have threads


@dataclass(frozen=True)
class Work:
    """What to do; functions of a module, so that other processes find them.

    Attributes
    ----------
    prepare : callable
        From the store to the tool.
    do : callable
        Store, tool and path to how it ended and the error, empty if none.
    """

    prepare: Callable[[Store], Any]
    do: Callable[[Store, Any, int], tuple[str, str]]


def each(
    work: Work,
    store: Store,
    paths: list[int],
    *,
    workers: int = 1,
    scheduler: str | None = None,
) -> Generator[Result]:
    """Do the paths and yield the results as they come.

    Parameters
    ----------
    work : Work
    store : Store
    paths : list of int
    workers : int
        Processes on this machine, each with one thread; 1 works in this process.
    scheduler : str, optional
        Address of a Dask scheduler (``tcp://…``, ``tls://…``) whose workers see the
        store under the same absolute path; `workers` is then ignored.

    Raises
    ------
    InputError
        If `workers` is less than 1 or the scheduler does not answer.
    """
    if workers < 1:
        raise InputError(f"workers must be 1 or more (got {workers})")
    if not paths:
        return
    workers = min(workers, len(paths))
    if workers == 1 and scheduler is None:
        tool = work.prepare(store)
        yield from ((i, *work.do(store, tool, i)) for i in paths)
        return
    there = partial(_do, work, str(store.path.resolve()), store.definition_hash)
    if scheduler is not None:
        yield from cluster.spread(there, paths, scheduler)
    else:
        yield from processes.spread(there, paths, workers)


def _do(work: Work, store_path: str, definition: str, i: int) -> tuple[str, str]:
    """Do path `i` in a worker process."""
    with _one_at_a_time:
        return work.do(*_equipment(work, store_path, definition), i)


@lru_cache(maxsize=1)
def _equipment(work: Work, store_path: str, definition: str) -> tuple[Store, Any]:
    """Return a worker's store and tool, made when it first needs them.

    A worker may outlive the store, so its definition is part of the key.
    """
    store = Store(store_path)
    if store.definition_hash != definition:
        raise InputError(f"store {store_path} is not the one the run was started with")
    return store, work.prepare(store)
