"""A short form of tests/faults/server_load.py: nobody is dropped, all are served."""

import argparse
import asyncio

import psutil
import pytest
from live_server import Address

from faults.server_load import load


@pytest.mark.slow
def test_several_clients_at_once(address: Address) -> None:
    given = argparse.Namespace(minutes=0.15, clients=4, rate=30.0)
    seen = asyncio.run(load(address.page, psutil.Process(), given))
    assert seen.dropped == []
    assert len(seen.seconds) > 4
    assert seen.errors > 0
