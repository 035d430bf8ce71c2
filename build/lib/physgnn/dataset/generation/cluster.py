"""Work on load paths wherever a Dask scheduler has workers.

Whoever reaches a scheduler without TLS can run code as its workers' user:
docs/howto/cluster.md says how to secure one.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from physgnn.errors import InputError

TIMEOUT_SECONDS = 10
Do = Callable[[int], tuple[str, str]]


def spread(do: Do, paths: list[int], scheduler: str) -> Iterator[tuple[int, str, str]]:
    """Do paths on a cluster and yield the results as they come.

    Parameters
    ----------
    do : callable
        From a path to how it ended and the error, empty if none. It can be pickled.
    paths : list of int
    scheduler : str
        The address, ``tcp://…`` or ``tls://…``. Keys and certificates are those of
        Dask's configuration.

    Raises
    ------
    InputError
        If the scheduler does not answer, and what `do` raises of this kind.
    """
    # half a second that a run on this machine need not spend
    from distributed import as_completed

    with _connected(scheduler) as client:
        futures = client.map(do, paths, pure=False)
        index = dict(zip((future.key for future in futures), paths, strict=True))
        for future in as_completed(futures):
            error = future.exception()  # of cluster or tool: a path's own are caught
            if isinstance(error, InputError):  # the tool's, and so every path's
                raise error
            i = index[future.key]
            yield (i, "error", str(error)) if error else (i, *future.result())


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
