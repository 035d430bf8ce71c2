"""Processes that solve: on this machine, or wherever a Dask scheduler has them."""

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from physgnn.errors import InputError

TIMEOUT_SECONDS = 10
# Two workers of two threads on two cores take longer than two of one.
ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
}
# Dask tells glibc to hand freed memory back at once. Every temporary array then costs
# page faults: 426,000 a load path instead of 300, a sixth of the time.
KEEP_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(2**30),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
}


@contextmanager
def connect(workers: int, scheduler: str | None) -> Iterator[Any]:
    """Connect to a scheduler, or start processes on this machine."""
    # half a second that a run in one process need not spend
    from distributed import Client, LocalCluster

    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=TIMEOUT_SECONDS)
        except (OSError, ValueError) as error:
            raise InputError(
                f"no Dask scheduler answers at {scheduler} ({error}); start one with "
                "'dask scheduler'"
            ) from error
        with client:
            yield client
        return
    with (
        _environment(ONE_THREAD | KEEP_MEMORY),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",  # any port: two runs must not collide
            silence_logs=logging.CRITICAL,  # a lost path is solved again: no news
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables, which started processes inherit, for a while."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
