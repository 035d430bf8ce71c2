"""Work on load paths wherever a Dask scheduler has workers.

Whoever reaches a scheduler without TLS can run code as its workers' user:
docs/howto/cluster.md says how to secure one.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from physgnn.dataset.generation.abreast import Do, side_by_side
from physgnn.errors import InputError

TIMEOUT_SECONDS = 10
TASKS = 2  # for each worker at least, or some would be left without
Result = tuple[int, str, str]


def spread(
    do: Do, paths: list[int], scheduler: str, *, most: int = 1
) -> Iterator[Result]:
    """Do paths on a cluster and yield the results as they come.

    Parameters
    ----------
    do : callable
        From a path to how it ended and the error, empty if none. It can be pickled.
    paths : list of int
    scheduler : str
        The address, ``tcp://…`` or ``tls://…``. Keys and certificates are those of
        Dask's configuration.
    most : int
        Paths that a worker does side by side, at most.

    Raises
    ------
    InputError
        If the scheduler does not answer, and what `do` raises of this kind.
    """
    # half a second that a run on this machine need not spend
    from distributed import as_completed

    with _connected(scheduler) as client:
        # What a worker that dies was at is done again: some paths each, not all.
        size = max(1, min(most, len(paths) // (TASKS * max(len(client.nthreads()), 1))))
        tasks = [paths[at : at + size] for at in range(0, len(paths), size)]
        futures = client.map(partial(_do_all, do), tasks, pure=False)
        index = dict(zip((future.key for future in futures), tasks, strict=True))
        for future in as_completed(futures):
            error = future.exception()  # of cluster or tool: a path's own are caught
            if isinstance(error, InputError):  # the tool's, and so every path's
                raise error
            lost = ((i, "error", str(error)) for i in index[future.key])
            yield from lost if error else future.result()


def _do_all(do: Do, paths: list[int]) -> list[Result]:
    """Do a task's paths side by side, in a worker."""
    return list(side_by_side(do, paths, len(paths), stop=lambda: None))


@contextmanager
def _connected(scheduler: str) -> Iterator[Any]:
    from distributed import Client

    try:
        client = Client(scheduler, timeout=TIMEOUT_SECONDS)
    except Exception as error:  # an address or a certificate can be wrong in many ways
        raise InputError(
            f"no Dask scheduler answers at {scheduler} ({error}); start one with "
            "'dask scheduler'"
        ) from error
    with client:
        yield client
