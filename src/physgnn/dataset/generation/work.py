"""Work on load paths, one by one or side by side: in this process, or in many.

Every process opens the store, prepares what the work needs once (a solver, say), and
does the paths it is given. A path whose worker dies goes to another one.
"""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from functools import lru_cache, partial
from threading import Lock
from typing import Any

from physgnn.dataset.generation import cluster, processes
from physgnn.dataset.generation.abreast import side_by_side
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError

Result = tuple[int, str, str]
"""Load path, how it ended, and the error if it raised one."""

_one_at_a_time = Lock()  # tools are one worker's, and a worker may have threads


def _one(_: Store) -> int:
    return 1


def _nothing(_: Any) -> None:
    pass


@dataclass(frozen=True)
class Work:
    """What to do; functions of a module, so that other processes find them.

    Attributes
    ----------
    prepare : callable
        From the store to the tool.
    do : callable
        Store, tool and path to how it ended and the error, empty if none.
    abreast : callable
        From the store to how many paths a process does side by side, with one tool.
    stop : callable
        Makes those that a tool is at end soon.
    """

    prepare: Callable[[Store], Any]
    do: Callable[[Store, Any, int], tuple[str, str]]
    abreast: Callable[[Store], int] = _one
    stop: Callable[[Any], object] = _nothing


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
    there = partial(_do, work, str(store.path.resolve()), store.definition_hash)
    if scheduler is not None:
        yield from cluster.spread(there, paths, scheduler, most=work.abreast(store))
    elif workers > 1:
        yield from processes.spread(there, paths, workers, most=work.abreast(store))
    else:
        yield from _here(work, store, paths)


def _here(work: Work, store: Store, paths: list[int]) -> Iterator[Result]:
    """Do paths in this process."""
    tool, most = work.prepare(store), work.abreast(store)
    do = partial(work.do, store, tool)
    if most == 1:
        yield from ((i, *do(i)) for i in paths)
    else:
        yield from side_by_side(do, paths, most, partial(work.stop, tool))


def _do(work: Work, store_path: str, definition: str, i: int) -> tuple[str, str]:
    """Do path `i` in a worker process."""
    with _one_at_a_time:
        store, tool = _equipment(work, store_path, definition)
        if work.abreast(store) == 1:
            return work.do(store, tool, i)
    return work.do(store, tool, i)


@lru_cache(maxsize=1)
def _equipment(work: Work, store_path: str, definition: str) -> tuple[Store, Any]:
    """Return a worker's store and tool, made when it first needs them.

    A worker may outlive the store, so its definition is part of the key.
    """
    store = Store(store_path)
    if store.definition_hash != definition:
        raise InputError(f"store {store_path} is not the one the run was started with")
    return store, work.prepare(store)
